#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/result.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/stored_chunk.hpp"
#include "io/files/thread_limit.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/answer.hpp"
#include "io/result/as_numbers.hpp"
#include "io/result/result.hpp"

namespace clearway {
namespace {

/// Reads rows of several columns together. The thread that calls HDF5 reads their chunks, and
/// meanwhile other threads check, decode and hash those that were read. finish() returns only
/// whether all is well; to find out what is wrong, the caller reads the rows again one after the
/// other, so that messages are always the same.
class ParallelRead {
 public:
  ParallelRead() = default;
  ParallelRead(const ParallelRead&) = delete;
  ParallelRead& operator=(const ParallelRead&) = delete;
  ~ParallelRead() { wait(); }

  /// Reads the chunks of rows from `first`, which begins a chunk, as many as `out` has. chunks:
  /// holds them, and must outlive this object as `out` and `hash` must. check(first row, values)
  /// throws InputError for rows that are wrong and is thread safe. Returns false where the chunks
  /// cannot be read.
  template <typename Number, typename Value, typename Check>
  bool add(const hdf5::Rows<Number>& dataset, std::uint64_t first, std::span<Value> out,
           hdf5::StoredChunks& chunks, Xxh64Stream& hash, Check check) {
    const std::uint64_t rows = dataset.chunk_rows();
    const bool read = dataset.read_chunks(first, out.size(), chunks, [&](std::size_t i) {
      const std::size_t from = i * rows;
      const std::span<Value> part = out.subspan(from, std::min(rows, out.size() - from));
      run([this, chunk = chunks[i], part, check, row = first + from] {
        if (!well_) return;
        if (hdf5::is_sealed(chunk)) {
          std::memcpy(part.data(), chunk.data(), part.size_bytes());
          if (passes(check, row, std::span<const Value>(part))) return;
        }
        well_ = false;
      });
    });
    if (!read) return false;
    Column& column = columns_.emplace_back(Column{hash, &hash});
    run([&column, &chunks, bytes = out.size_bytes()] {
      std::size_t left = bytes;
      for (std::size_t i = 0; i < chunks.size(); ++i) {
        const std::span<const std::byte> chunk = chunks[i];
        const std::size_t used = std::min(left, chunk.size() - hdf5::kChecksumBytes);
        column.hash.update(chunk.first(used));
        left -= used;
      }
    });
    return true;
  }

  /// Waits for all that was added. Returns whether all rows are intact and pass their checks; if
  /// so, the rows and the hashes are complete.
  bool finish();

 private:
  /// The hash of a column, which becomes the caller's where all is well.
  struct Column {
    Xxh64Stream hash;
    Xxh64Stream* of_caller;
  };

  template <typename Check, typename Value>
  static bool passes(const Check& check, std::uint64_t row, std::span<const Value> values) {
    try {
      check(row, values);
    } catch (const InputError&) {
      return false;
    }
    return true;
  }

  template <typename Task>
  void run(Task task) {
    scope_.begin();
    tasks_.run(piece_of(scope_, std::move(task)));
  }

  void wait() {
    tasks_.wait();
    scope_.end();
  }

  ParallelScope scope_;
  tbb::task_group tasks_;
  std::atomic<bool> well_ = true;
  std::deque<Column> columns_;
};

bool ParallelRead::finish() {
  wait();
  if (!well_) return false;
  for (const Column& column : columns_) *column.of_caller = column.hash;
  return true;
}

/// Calls `call` and turns a failure of HDF5 into an InputError: since the file could be opened, its
/// content must be damaged. Errors of system calls pass through.
template <typename Call>
auto as_input(const std::string& name, Call call) {
  const hdf5::QuietScope quiet;
  try {
    return call();
  } catch (const hdf5::Failure& error) {
    throw InputError(name + ": damaged: " + error.what());
  }
}

void check_range(std::uint64_t first, std::size_t count, std::uint64_t rows) {
  if (first > rows || count > rows - first) {
    throw std::logic_error("ResultReader: rows past the end");
  }
}

/// A dataset that is read, or nothing where the result does not have the column.
template <typename Value>
using OptionalRead = std::optional<hdf5::Rows<typename StoredValue<Value>::Number>>;

/// The most rows that are read at a time and whose chunks' memory is kept for the next ones.
constexpr std::size_t kMostKeptRows = 4 * kEncodedRows;

/// The datasets of a table, which are read together.
template <typename Rows>
class TableReader {
 public:
  /// Opens the datasets that a result with this header has. name: that of the file. Both must
  /// outlive this object.
  TableReader(const hdf5::Id& file, const std::string& name, const ResultHeader& header)
      : name_(name), header_(header) {
    if (!Table<Rows>::is_in(header)) return;
    std::size_t columns = 0;
    for_each_column<Rows>(datasets_, [&](const auto& column, auto& dataset) {
      using Value = typename std::decay_t<decltype(column)>::Value;
      using Dataset = typename std::decay_t<decltype(dataset)>::value_type;
      if (!column.is_in(header)) return;
      const std::string path = std::string(Table<Rows>::kGroup) + "/" + column.dataset;
      dataset.emplace(Dataset::open(file, path, StoredValue<Value>::kNumbers, name));
      ++columns;
      if (!rows_) rows_ = dataset->rows();
      if (dataset->rows() == *rows_) return;
      throw InputError(name + ": the datasets of /" + Table<Rows>::kGroup +
                       " differ in their rows");
    });
    hashes_ = hdf5::read_attribute<std::uint64_t>(file, Table<Rows>::kHash, columns, name);
  }

  std::uint64_t rows() const { return rows_.value_or(0); }
  std::uint64_t recorded_hash() const {
    if (!rows_) return 0;
    ColumnHashes of_table;
    for (const std::uint64_t hash : hashes_) of_table.add_digest(hash);
    return of_table.digest();
  }

  void read(std::uint64_t first, std::size_t count, Rows& out, RowHashes<Rows>& hashes) const {
    check_range(first, count, rows());
    for_each_column<Rows>(datasets_, [&](const auto& column, const auto& dataset) {
      (out.*column.values).resize(dataset ? count : 0);
    });
    if (!read_chunks(first, count, out, hashes)) read_in_order(first, out, hashes);
    Table<Rows>::check(read_from(first), out);
  }

  void check_hashes(const RowHashes<Rows>& hashes) const {
    std::size_t i = 0, recorded = 0;
    for_each_column<Rows>(datasets_, [&](const auto& column, const auto& dataset) {
      const Xxh64Stream& hash = hashes[i++];
      if (dataset) check_hash(column.dataset, hash.digest(), hashes_[recorded++]);
    });
  }

  template <typename Value>
  std::vector<Value> column(std::vector<Value> Rows::*values) const {
    std::vector<Value> out;
    std::size_t recorded = 0;
    for_each_column<Rows>(datasets_, [&](const auto& column, const auto& dataset) {
      if (!dataset) return;
      const std::uint64_t hash = hashes_[recorded++];
      if constexpr (std::is_same_v<decltype(column.values), std::vector<Value> Rows::*>) {
        if (column.values != values) return;
        out.resize(rows());
        Xxh64Stream found;
        if (!read_whole(*dataset, std::span(out), found)) {
          as_input(name_, [&] { dataset->read(0, numbers_of(std::span(out))); });
          found.update(std::as_bytes(std::span(out)));
        }
        check_hash(column.dataset, found.digest(), hash);
        column.check(read_from(0), column.dataset, out);
      }
    });
    return out;
  }

 private:
  /// Reads a whole column by many threads. Returns false as read_chunks() does.
  template <typename Dataset, typename Value>
  bool read_whole(const Dataset& dataset, std::span<Value> out, Xxh64Stream& hash) const {
    hdf5::StoredChunks chunks;
    const auto unchecked = [](std::uint64_t, std::span<const Value>) {};
    const auto read_all = [&] {
      ParallelRead read;
      return read.add(dataset, 0, out, chunks, hash, unchecked) && read.finish();
    };
    return in_all_threads([&] { return as_input(name_, read_all); });
  }

  void check_hash(const char* dataset, std::uint64_t found, std::uint64_t recorded) const {
    if (found == recorded) return;
    throw InputError(name_ + ": /" + Table<Rows>::kGroup + "/" + dataset +
                     ": its rows are damaged (their hash is not the one recorded)");
  }

  RowsRead read_from(std::uint64_t first) const {
    return {name_, header_, Table<Rows>::kGroup, first};
  }

  template <typename Value, typename Dataset>
  void read_column(const Column<Rows, Value>& column, const Dataset& dataset, std::uint64_t first,
                   std::span<Value> out) const {
    as_input(name_, [&] { dataset.read(first, numbers_of(out)); });
    column.check(read_from(first), column.dataset, out);
  }

  void read_in_order(std::uint64_t first, Rows& out, RowHashes<Rows>& hashes) const {
    std::size_t i = 0;
    for_each_column<Rows>(datasets_, [&](const auto& column, const auto& dataset) {
      Xxh64Stream& hash = hashes[i++];
      if (!dataset) return;
      const auto values = std::span(out.*column.values);
      read_column(column, *dataset, first, values);
      hash.update(std::as_bytes(values));
    });
  }

  /// Reads rows that begin and end with chunks by many threads. Returns false where they do not,
  /// where the chunks are stored in another way, and where anything about them is wrong, which
  /// read_in_order() then names.
  bool read_chunks(std::uint64_t first, std::size_t count, Rows& out,
                   RowHashes<Rows>& hashes) const {
    const bool whole =
        first % kEncodedRows == 0 && (count % kEncodedRows == 0 || first + count == rows());
    if (!whole) return false;
    std::array<hdf5::StoredChunks, kColumnsOf<Rows>> of_this_call;
    auto& chunks = count <= kMostKeptRows ? chunks_ : of_this_call;
    const auto read_all = [&] {
      ParallelRead read;
      bool readable = true;
      std::size_t i = 0;
      for_each_column<Rows>(datasets_, [&](const auto& column, const auto& dataset) {
        hdf5::StoredChunks& of_column = chunks[i];
        Xxh64Stream& hash = hashes[i++];
        if (!dataset || !readable) return;
        using Value = typename std::decay_t<decltype(column)>::Value;
        readable = read.add(*dataset, first, std::span(out.*column.values), of_column, hash,
                            [this, &column](std::uint64_t row, std::span<const Value> values) {
                              column.check(read_from(row), column.dataset, values);
                            });
      });
      return readable && read.finish();
    };
    return in_all_threads([&] { return as_input(name_, read_all); }) && is_ordered(out);
  }

  /// Whether the rows are in order also from each chunk to the next, which no check of a chunk
  /// sees.
  static bool is_ordered(const Rows& rows) {
    const auto& order = rows.*Table<Rows>::kOrder;
    for (std::size_t i = 1; i < order.size(); ++i) {
      if (!Table<Rows>::may_follow(order[i - 1], order[i])) return false;
    }
    return true;
  }

  const std::string& name_;
  const ResultHeader& header_;
  PerColumn<Rows, OptionalRead> datasets_;
  /// Memory for the chunks of each column. As with HDF5 itself, one thread at a time reads.
  mutable std::array<hdf5::StoredChunks, kColumnsOf<Rows>> chunks_;
  std::optional<std::uint64_t> rows_;  ///< nullopt where the result does not have the table
  std::vector<std::uint64_t> hashes_;  ///< recorded, of the columns that the result has
};

}  // namespace

/// The open file and tables of a result that is read.
struct ResultReader::State {
  explicit State(const std::filesystem::path& path)
      : name(path.string()),
        file(hdf5::open_file(path)),
        header(read_result_header(file, name)),
        findings(read_result_findings(file, name, header)),
        attributes(hdf5::hash_of_attributes(file, name)),
        tables(TableReader<Collisions>(file, name, header),
               TableReader<Clearances>(file, name, header),
               TableReader<ProfileRows>(file, name, header),
               TableReader<Nearby>(file, name, header),
               TableReader<UnseenCubes>(file, name, header),
               TableReader<SweptCells>(file, name, header)) {
    if (header.profile > 0 && table<ProfileRows>().rows() != header.poses) {
      throw InputError(name + ": /profile has " + std::to_string(table<ProfileRows>().rows()) +
                       " rows, expected one for each of " + std::to_string(header.poses) +
                       " poses");
    }
  }

  template <typename Rows>
  const TableReader<Rows>& table() const {
    return std::get<TableReader<Rows>>(tables);
  }

  std::string name;
  hdf5::Id file;
  ResultHeader header;
  ResultFindings findings;
  std::uint64_t attributes;  ///< hash of all of them, among which are the hashes of the tables
  std::tuple<TableReader<Collisions>, TableReader<Clearances>, TableReader<ProfileRows>,
             TableReader<Nearby>, TableReader<UnseenCubes>, TableReader<SweptCells>>
      tables;
};

ResultReader::ResultReader(const std::filesystem::path& path, Parts parts) {
  state_ = as_input(path.string(), [&] { return std::make_unique<State>(path); });
  if (parts == Parts::kAccepted || !header().part) return;
  throw InputError(name() + ": is " + in_words(header().part->shard) +
                       " of a result, and says nothing of the rest",
                   Remedy::kMerge);
}

ResultReader::~ResultReader() {
  const hdf5::QuietScope quiet;
  state_.reset();
}
ResultReader::ResultReader(ResultReader&&) noexcept = default;
ResultReader& ResultReader::operator=(ResultReader&& other) noexcept {
  const hdf5::QuietScope quiet;
  state_ = std::move(other.state_);
  return *this;
}

const std::string& ResultReader::name() const { return state_->name; }
const ResultHeader& ResultReader::header() const { return state_->header; }
const ResultFindings& ResultReader::findings() const { return state_->findings; }

template <typename Rows>
std::uint64_t ResultReader::rows() const {
  return state_->table<Rows>().rows();
}

std::uint64_t ResultReader::identity() const {
  ColumnHashes all;
  all.add_digest(state_->attributes);
  // Their texts name files, which may be called otherwise the next time.
  for (const Message& warning : findings().warnings) all.add(warning.code);
  return all.digest();
}

template <typename Rows>
std::uint64_t ResultReader::recorded_hash() const {
  return state_->table<Rows>().recorded_hash();
}

template <typename Rows>
void ResultReader::read(std::uint64_t first, std::size_t count, Rows& out,
                        RowHashes<Rows>& hashes) const {
  state_->table<Rows>().read(first, count, out, hashes);
}

template <typename Rows>
void ResultReader::check_hashes(const RowHashes<Rows>& hashes) const {
  state_->table<Rows>().check_hashes(hashes);
}

template <typename Rows, typename Value>
std::vector<Value> ResultReader::column(std::vector<Value> Rows::*values) const {
  return state_->table<Rows>().column(values);
}

template std::uint64_t ResultReader::rows<Collisions>() const;
template std::uint64_t ResultReader::rows<Clearances>() const;
template std::uint64_t ResultReader::rows<ProfileRows>() const;
template std::uint64_t ResultReader::rows<Nearby>() const;
template std::uint64_t ResultReader::rows<UnseenCubes>() const;
template std::uint64_t ResultReader::rows<SweptCells>() const;
template std::uint64_t ResultReader::recorded_hash<Collisions>() const;
template void ResultReader::read(std::uint64_t, std::size_t, Collisions&,
                                 RowHashes<Collisions>&) const;
template void ResultReader::read(std::uint64_t, std::size_t, Clearances&,
                                 RowHashes<Clearances>&) const;
template void ResultReader::read(std::uint64_t, std::size_t, ProfileRows&,
                                 RowHashes<ProfileRows>&) const;
template void ResultReader::read(std::uint64_t, std::size_t, Nearby&, RowHashes<Nearby>&) const;
template void ResultReader::check_hashes<Nearby>(const RowHashes<Nearby>&) const;
template void ResultReader::read(std::uint64_t, std::size_t, UnseenCubes&,
                                 RowHashes<UnseenCubes>&) const;
template void ResultReader::check_hashes<UnseenCubes>(const RowHashes<UnseenCubes>&) const;
template void ResultReader::read(std::uint64_t, std::size_t, SweptCells&,
                                 RowHashes<SweptCells>&) const;
template void ResultReader::check_hashes<SweptCells>(const RowHashes<SweptCells>&) const;
template void ResultReader::check_hashes<Collisions>(const RowHashes<Collisions>&) const;
template void ResultReader::check_hashes<Clearances>(const RowHashes<Clearances>&) const;
template void ResultReader::check_hashes<ProfileRows>(const RowHashes<ProfileRows>&) const;
template std::vector<std::uint64_t> ResultReader::column(
    std::vector<std::uint64_t> Collisions::*) const;
template std::vector<Vec3> ResultReader::column(std::vector<Vec3> Collisions::*) const;
template std::vector<std::uint32_t> ResultReader::column(
    std::vector<std::uint32_t> Collisions::*) const;

Result::Result(const std::filesystem::path& path) : reader_(std::make_unique<ResultReader>(path)) {}
Result::~Result() = default;
Result::Result(Result&&) noexcept = default;
Result& Result::operator=(Result&&) noexcept = default;

std::uint64_t Result::size() const { return reader_->collisions(); }
const QueryParameters& Result::parameters() const { return reader_->header(); }
std::uint64_t Result::environment_points() const { return reader_->header().environment_points; }
const IgnoredPointCounts& Result::ignored() const { return reader_->header().ignored; }
std::uint64_t Result::poses() const { return reader_->header().poses; }
Answer Result::answer() const { return answer_of(*reader_); }
const std::vector<Message>& Result::warnings() const { return reader_->findings().warnings; }

Collisions Result::collisions() const { return reader_->all<Collisions>(); }

std::vector<std::uint64_t> Result::source() const { return reader_->column(&Collisions::source); }
std::vector<Vec3> Result::xyz() const { return reader_->column(&Collisions::xyz); }
std::vector<std::uint32_t> Result::first_pose() const {
  return reader_->column(&Collisions::first_pose);
}
std::vector<std::uint32_t> Result::last_pose() const {
  return reader_->column(&Collisions::last_pose);
}
std::vector<std::uint32_t> Result::first_body() const { return reader_->column(&Collisions::body); }
const std::vector<std::string>& Result::bodies() const { return reader_->header().bodies; }

UnseenCubes Result::unseen() const { return reader_->all<UnseenCubes>(); }
Nearby Result::near() const { return reader_->all<Nearby>(); }
Clearances Result::clearance() const { return reader_->all<Clearances>(); }

Profile Result::profile() const {
  auto out = reader_->all<ProfileRows>();
  for (const auto& [first, last] : reader_->findings().without_bodies) {
    std::fill(out.distance.begin() + first, out.distance.begin() + last + 1,
              std::numeric_limits<double>::quiet_NaN());
  }
  return std::move(static_cast<Profile&>(out));
}

double Result::model_spacing() const { return reader_->header().notes.model_spacing; }

ModelAxes Result::model_axes() const { return reader_->header().notes.model_axes; }

Box Result::model_box() const { return reader_->header().model_box; }

}  // namespace clearway
