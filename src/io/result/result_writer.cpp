#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/file.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/as_numbers.hpp"
#include "io/result/result.hpp"

namespace clearway {
namespace {

/// A dataset of numbers or points that is written chunk by chunk.
template <typename Value>
class ResultColumn {
 public:
  ResultColumn(const hdf5::Id& group, const char* name, std::uint64_t rows)
      : dataset_(group, name, rows, StoredValue<Value>::kNumbers) {}

  void hash(const EncodedColumn<Value>& values) {
    for (const EncodedChunk& chunk : values.chunks()) hash_.update(chunk.values());
  }

  void write(EncodedColumn<Value>& values) {
    if (!values.chunks().empty() && !std::exchange(has_index_, true)) dataset_.make_index();
    for (EncodedChunk& chunk : values.chunks()) {
      const std::size_t bytes = chunk.size;
      held_.push_back(std::move(chunk));
      if (held_.size() * (bytes - hdf5::kChecksumBytes) > kHeldBytes) write_oldest();
    }
  }

  void write_held() {
    while (!held_.empty()) write_oldest();
  }

  std::uint64_t digest() const { return hash_.digest(); }

 private:
  using Number = typename StoredValue<Value>::Number;

  /// Bytes of a column that are held back before they are written. A chunk gets its place in the
  /// file when it is written, so it is written when HDF5's own cache, of one MiB per dataset, would
  /// have written it.
  static constexpr std::size_t kHeldBytes = 1 << 20;

  void write_oldest() {
    const EncodedChunk& chunk = held_.front();
    dataset_.write_chunk(next_row_, chunk.stored());
    next_row_ += (chunk.size - hdf5::kChecksumBytes) / sizeof(Value);
    held_.pop_front();
  }

  hdf5::Rows<Number> dataset_;
  std::deque<EncodedChunk> held_;
  std::uint64_t next_row_ = 0;
  bool has_index_ = false;
  Xxh64Stream hash_;
};

/// A dataset that is written, or nothing where the result does not have the column.
template <typename Value>
using OptionalWritten = std::optional<ResultColumn<Value>>;

/// A group of datasets with the same number of rows, which are written in pieces.
template <typename Rows>
class TableWriter {
 public:
  /// rows: the promised number of rows. The header must outlive this object.
  TableWriter(const hdf5::Id& file, const ResultHeader& header, std::uint64_t rows)
      : group_(hdf5::create_group(file, Table<Rows>::kGroup)), header_(header), promised_(rows) {
    for_each_column<Rows>(columns_, [&](const auto& column, auto& dataset) {
      if (column.is_in(header)) dataset.emplace(group_, column.dataset, rows);
    });
  }

  /// Bytes that the chunks of all promised rows take in the file.
  std::uint64_t bytes() const {
    std::uint64_t total = 0;
    for_each_column<Rows>(columns_, [&](const auto& column, const auto& dataset) {
      using Value = typename std::decay_t<decltype(column)>::Value;
      if (dataset) total += stored_bytes<Value>(promised_);
    });
    return total;
  }

  EncodedRows<Rows> new_rows() const { return {promised_, header_}; }

  /// Adds sealed rows to the hashes. The rows come in order and kEncodedRows at a time, except for
  /// a table's last.
  void hash(const EncodedRows<Rows>& rows) {
    each_with(rows.columns(), [](auto& dataset, const auto& values) { dataset.hash(values); });
  }

  void write(EncodedRows<Rows>& rows) {
    check_order(rows);
    each_with(rows.columns(), [](auto& dataset, auto& values) { dataset.write(values); });
    written_ += rows.size();
    last_source_ = rows.last_source();
  }

  /// Appends any number of rows. Throws std::logic_error as EncodedRows does, and for more rows
  /// than promised.
  void append(const Rows& rows) {
    if (rows.size() > promised_ - written_ - (buffered_ ? buffered_->size() : 0)) too_many();
    std::size_t from = 0;
    do {
      if (!buffered_) buffered_.emplace(new_rows());
      const std::size_t count = std::min(rows.size() - from, kEncodedRows - buffered_->size());
      buffered_->add(rows, from, count);
      from += count;
      if (buffered_->size() == kEncodedRows) flush();
    } while (from < rows.size());
  }

  void flush() {
    if (!buffered_) return;
    buffered_->seal();
    hash(*buffered_);
    write(*buffered_);
    buffered_.reset();
  }

  void check_complete() const {
    const std::uint64_t rows = written_ + (buffered_ ? buffered_->size() : 0);
    if (rows == promised_) return;
    throw std::logic_error("ResultWriter: " + std::to_string(rows) + " rows written, " +
                           std::to_string(promised_) + " promised");
  }

  /// Writes the chunks that are held back. Nothing is written after them.
  void write_held() {
    std::apply([](auto&... dataset) { ((dataset ? dataset->write_held() : void()), ...); },
               columns_);
  }

  void write_hash(const hdf5::Id& file) {
    std::vector<std::uint64_t> hashes;
    for_each_column<Rows>(columns_, [&](const auto&, const auto& dataset) {
      if (dataset) hashes.push_back(dataset->digest());
    });
    hdf5::write_attribute<std::uint64_t>(file, Table<Rows>::kHash, hashes);
  }

 private:
  [[noreturn]] static void too_many() {
    throw std::logic_error("ResultWriter: more rows than promised");
  }

  void check_order(const EncodedRows<Rows>& rows) const {
    if (rows.size() > promised_ - written_) too_many();
    if (rows.size() < kEncodedRows && written_ + rows.size() < promised_) {
      throw std::logic_error("ResultWriter: rows in pieces of another length");
    }
    if (written_ > 0 && rows.size() > 0 && rows.has_sources() &&
        rows.first_source() <= last_source_) {
      throw std::logic_error("ResultWriter: rows not ascending by source");
    }
  }

  /// Calls visit(dataset, its values) for the columns that are written.
  template <typename Columns, typename Visit>
  void each_with(Columns& values, Visit visit) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((std::get<I>(columns_) ? visit(*std::get<I>(columns_), *std::get<I>(values)) : void()), ...);
    }
    (std::make_index_sequence<kColumnsOf<Rows>>());
  }

  hdf5::Id group_;
  PerColumn<Rows, OptionalWritten> columns_;
  const ResultHeader& header_;
  std::uint64_t promised_, written_ = 0, last_source_ = 0;
  std::optional<EncodedRows<Rows>> buffered_;
};

namespace names = result_names;

}  // namespace

struct ResultWriter::State {
  State(const std::filesystem::path& path, const ResultHeader& result, std::uint64_t collisions,
        std::uint64_t clearances, std::uint64_t near, std::uint64_t unseen, std::uint64_t swept)
      : name(path.string()),
        header(result),
        file(hdf5::create_file(path)),
        output(File::open_for_writing(path)) {
    begin<Collisions>(collisions);
    begin<Clearances>(clearances);
    begin<ProfileRows>(header.poses);
    begin<Nearby>(near);
    begin<UnseenCubes>(unseen);
    begin<SweptCells>(swept);
    write_result_header(file, header);
    std::uint64_t bytes = 0;
    each([&](auto& table) { bytes += table.bytes(); });
    output.reserve_ahead(bytes);
  }

  template <typename Rows>
  void begin(std::uint64_t rows) {
    if (Table<Rows>::is_in(header)) optional_table<Rows>().emplace(file, header, rows);
  }

  template <typename Rows>
  std::optional<TableWriter<Rows>>& optional_table() {
    return std::get<std::optional<TableWriter<Rows>>>(tables);
  }

  template <typename Rows>
  TableWriter<Rows>& table() {
    if (auto& table = optional_table<Rows>()) return *table;
    throw std::logic_error(std::string("ResultWriter: no ") + Table<Rows>::kGroup);
  }

  /// Calls visit(table) for the tables that the result has, in the order of the file.
  template <typename Visit>
  void each(Visit visit) {
    std::apply([&](auto&... table) { ((table ? visit(*table) : void()), ...); }, tables);
  }

  /// Checks that the tables before that of these rows have all of their promised rows, and flushes
  /// them.
  template <typename Rows>
  void complete_before() {
    bool before = true;
    each([&]<typename Other>(TableWriter<Other>& table) {
      before = before && !std::is_same_v<Other, Rows>;
      if (before) complete(table);
    });
  }

  template <typename Rows>
  void complete(TableWriter<Rows>& table) {
    table.check_complete();
    hdf5::naming(name, [&] { table.flush(); });
  }

  /// Starts the transfer of what has been written to the disk, while the rest is computed.
  void written() {
    constexpr std::uint64_t kAtOnce = std::uint64_t{32} << 20;
    const std::uint64_t end = output.size_bytes();
    if (end < synced + kAtOnce) return;
    output.begin_sync(synced, end - synced);
    synced = end;
  }

  std::string name;
  ResultHeader header;
  hdf5::Id file;
  File output;               ///< a second handle of the same file
  std::uint64_t synced = 0;  ///< bytes of the file that are on their way to the disk
  std::tuple<std::optional<TableWriter<Collisions>>, std::optional<TableWriter<Clearances>>,
             std::optional<TableWriter<ProfileRows>>, std::optional<TableWriter<Nearby>>,
             std::optional<TableWriter<UnseenCubes>>, std::optional<TableWriter<SweptCells>>>
      tables;
};

ResultWriter::ResultWriter(const std::filesystem::path& path, const ResultHeader& header,
                           std::uint64_t collisions, std::uint64_t clearances, std::uint64_t near,
                           std::uint64_t unseen, std::uint64_t swept)
    : state_(hdf5::naming(path.string(), [&] {
        return std::make_unique<State>(path, header, collisions, clearances, near, unseen, swept);
      })) {}

ResultWriter::~ResultWriter() {
  const hdf5::QuietScope quiet;
  state_.reset();
}

template <typename Rows>
void ResultWriter::append(const Rows& rows) {
  TableWriter<Rows>& table = state_->table<Rows>();
  state_->complete_before<Rows>();
  hdf5::naming(state_->name, [&] { table.append(rows); });
}

template <typename Rows>
EncodedRows<Rows> ResultWriter::new_rows() const {
  return state_->table<Rows>().new_rows();
}

template <typename Rows>
void ResultWriter::hash(const EncodedRows<Rows>& rows) {
  state_->table<Rows>().hash(rows);
}

template <typename Rows>
void ResultWriter::write(EncodedRows<Rows>& rows) {
  TableWriter<Rows>& table = state_->table<Rows>();
  state_->complete_before<Rows>();
  hdf5::naming(state_->name, [&] { table.write(rows); });
  state_->written();
}

void ResultWriter::finish(const ResultFindings& findings) {
  State& s = *state_;
  s.each([&](auto& table) { s.complete(table); });
  hdf5::naming(s.name, [&] {
    s.each([&](auto& table) { table.write_hash(s.file); });
    write_result_findings(s.file, findings, s.header);
    hdf5::write_number(s.file, "complete", std::uint8_t{1});
    s.each([](auto& table) { table.write_held(); });
    hdf5::check(H5Fflush(s.file.get(), H5F_SCOPE_LOCAL), "write the result");
    // After the flush, closing has nothing left to write and cannot fail for a full disk.
    std::apply([](auto&... table) { (table.reset(), ...); }, s.tables);
    s.file.close("close the result");
  });
}

template void ResultWriter::append(const Collisions&);
template void ResultWriter::append(const Clearances&);
template void ResultWriter::append(const ProfileRows&);
template void ResultWriter::append(const Nearby&);
template void ResultWriter::append(const UnseenCubes&);
template void ResultWriter::append(const SweptCells&);
template EncodedRows<Collisions> ResultWriter::new_rows() const;
template EncodedRows<Clearances> ResultWriter::new_rows() const;
template EncodedRows<Nearby> ResultWriter::new_rows() const;
template void ResultWriter::hash(const EncodedRows<Collisions>&);
template void ResultWriter::hash(const EncodedRows<Clearances>&);
template void ResultWriter::hash(const EncodedRows<Nearby>&);
template void ResultWriter::write(EncodedRows<Collisions>&);
template void ResultWriter::write(EncodedRows<Clearances>&);
template void ResultWriter::write(EncodedRows<Nearby>&);

}  // namespace clearway
