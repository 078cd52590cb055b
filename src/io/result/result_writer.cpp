#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "clearway/error.hpp"
#include "io/hdf5/hdf5.hpp"
#include "io/result/column_hashes.hpp"
#include "io/result/encoded_rows.hpp"
#include "io/result/result.hpp"
#include "io/result/result_header.hpp"
#include "io/result/result_names.hpp"
#include "io/system/file.hpp"

namespace clearway {
namespace {

/// A dataset of numbers or points that is written chunk by chunk.
template <typename Value>
class ResultColumn {
 public:
  ResultColumn(const hdf5::Id& group, const char* name, std::uint64_t rows)
      : dataset_(group, name, rows, kIsPoints ? 3 : 0) {}

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
  static constexpr bool kIsPoints = std::is_same_v<Value, Vec3>;
  using Number = std::conditional_t<kIsPoints, double, Value>;

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

/// A group of datasets with the same number of rows, which are written in pieces.
template <typename... Values>
class ResultTable {
 public:
  using Names = std::array<const char*, sizeof...(Values)>;
  using Rows = EncodedRows<Values...>;

  /// rows: the promised number of rows. A column whose name is null is not written.
  ResultTable(const hdf5::Id& file, const char* group, const Names& names, std::uint64_t rows)
      : group_(hdf5::create_group(file, group)), promised_(rows) {
    std::size_t i = 0;
    each([&](auto& column) {
      present_[i] = names[i] != nullptr;
      if (present_[i]) column.emplace(group_, names[i], rows);
      ++i;
    });
  }

  /// Bytes that the chunks of all promised rows take in the file.
  std::uint64_t bytes() const {
    std::uint64_t total = 0;
    std::size_t i = 0;
    ((total += present_[i++] ? stored_bytes<Values>(promised_) : 0), ...);
    return total;
  }

  Rows new_rows() const { return {promised_, present_}; }

  /// Adds sealed rows to the hashes. The rows come in order and kEncodedRows at a time, except for
  /// a table's last.
  void hash(const Rows& rows) {
    each_with(rows.columns(), [](auto& column, const auto& values) { column.hash(values); });
  }

  void write(Rows& rows) {
    check_order(rows);
    each_with(rows.columns(), [](auto& column, auto& values) { column.write(values); });
    written_ += rows.size();
    last_source_ = rows.last_source();
  }

  /// Appends any number of rows. Throws std::logic_error as EncodedRows does, and for more rows
  /// than promised.
  void append(std::span<const Values>... values) {
    const std::size_t rows = std::get<0>(std::tuple(values...)).size();
    check_lengths(rows, {values.size()...});
    if (rows > promised_ - written_ - (buffered_ ? buffered_->size() : 0)) too_many();
    std::size_t from = 0;
    do {
      if (!buffered_) buffered_.emplace(new_rows());
      const std::size_t count = std::min(rows - from, kEncodedRows - buffered_->size());
      buffered_->add(part_of(values, from, count)...);
      from += count;
      if (buffered_->size() == kEncodedRows) flush();
    } while (from < rows);
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
    each([](auto& column) {
      if (column) column->write_held();
    });
  }

  /// ColumnHashes of the first `columns` columns, or of all of them.
  std::uint64_t hash(std::size_t columns = sizeof...(Values)) {
    ColumnHashes hashes;
    std::size_t i = 0;
    each([&](auto& column) {
      if (i++ < columns && column) hashes.add_digest(column->digest());
    });
    return hashes.digest();
  }

  /// XXH64 of the last column, which must be one that is written.
  std::uint64_t hash_of_last() {
    return std::get<sizeof...(Values) - 1>(columns_).value().digest();
  }

 private:
  [[noreturn]] static void too_many() {
    throw std::logic_error("ResultWriter: more rows than promised");
  }

  void check_lengths(std::size_t rows,
                     const std::array<std::size_t, sizeof...(Values)>& lengths) const {
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      if (lengths[i] == (present_[i] ? rows : 0)) continue;
      throw std::logic_error("ResultWriter: rows of unequal lengths");
    }
  }

  void check_order(const Rows& rows) const {
    if (rows.size() > promised_ - written_) too_many();
    if (rows.size() < kEncodedRows && written_ + rows.size() < promised_) {
      throw std::logic_error("ResultWriter: rows in pieces of another length");
    }
    if (written_ > 0 && rows.size() > 0 && rows.has_sources() &&
        rows.first_source() <= last_source_) {
      throw std::logic_error("ResultWriter: rows not ascending by source");
    }
  }

  /// The values `from` to `from + count - 1` of a column, or none for a column that is not written.
  template <typename Value>
  static std::span<const Value> part_of(std::span<const Value> values, std::size_t from,
                                        std::size_t count) {
    return values.empty() ? values : values.subspan(from, count);
  }

  template <typename Visit>
  void each(Visit visit) {
    std::apply([&](auto&... column) { (visit(column), ...); }, columns_);
  }

  /// Calls visit(column, its values) for the columns that are written.
  template <typename Columns, typename Visit>
  void each_with(Columns& values, Visit visit) {
    const auto at = [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((std::get<I>(columns_) ? visit(*std::get<I>(columns_), *std::get<I>(values)) : void()), ...);
    };
    at(std::index_sequence_for<Values...>());
  }

  hdf5::Id group_;
  std::uint64_t promised_, written_ = 0, last_source_ = 0;
  typename Rows::Present present_{};
  std::tuple<std::optional<ResultColumn<Values>>...> columns_;
  std::optional<Rows> buffered_;
};

namespace names = result_names;

using CollisionTable =
    ResultTable<std::uint64_t, Vec3, std::uint32_t, std::uint32_t, std::uint32_t>;

/// Number of columns in the collisions' hash. The last poses, which older releases did not write,
/// have a hash of their own.
constexpr std::size_t kHashedColumns = 4;
using ClearanceTable = ResultTable<std::uint64_t, Vec3, double, std::uint32_t, std::uint32_t>;
using ProfileTable = ResultTable<double, std::uint64_t, Vec3, double, double>;

CollisionTable::Names collision_columns(const ResultHeader& header) {
  return {names::kSource, names::kXyz, header.first_pose ? names::kFirstPose : nullptr,
          header.has_first_bodies() ? names::kBody : nullptr,
          header.last_pose ? names::kLastPose : nullptr};
}

ClearanceTable::Names clearance_columns(const ResultHeader& header) {
  return {names::kSource, names::kXyz, names::kDistance, names::kPose,
          header.bodies.empty() ? nullptr : names::kBody};
}

ResultFindings without_doubts(ResultFindings findings) {
  findings.doubts.clear();
  return findings;
}

}  // namespace

struct ResultWriter::State {
  State(const std::filesystem::path& path, const ResultHeader& header, std::uint64_t rows,
        std::uint64_t clearance_rows)
      : name(path.string()),
        is_empty(rows == 0),
        file(hdf5::create_file(path)),
        output(File::open_for_writing(path)),
        has_last_pose(header.last_pose),
        collisions(std::in_place, file, names::kGroup, collision_columns(header), rows) {
    if (header.clearance > 0) {
      clearances.emplace(file, names::kClearanceGroup, clearance_columns(header), clearance_rows);
    }
    if (header.profile > 0) {
      profile.emplace(
          file, names::kProfileGroup,
          ProfileTable::Names{names::kDistance, names::kSource, names::kXyz, names::kChainage,
                              header.part ? names::kSquared : nullptr},
          header.poses);
    }
    write_result_header(file, header);
    output.reserve_ahead(collisions->bytes() + (clearances ? clearances->bytes() : 0) +
                         (profile ? profile->bytes() : 0));
  }

  /// Starts the transfer of what has been written to the disk, while the rest is computed.
  void written() {
    constexpr std::uint64_t kAtOnce = std::uint64_t{32} << 20;
    const std::uint64_t end = output.size_bytes();
    if (end < synced + kAtOnce) return;
    output.begin_sync(synced, end - synced);
    synced = end;
  }

  /// Checks that a table has all of its promised rows and flushes it, before those of the next
  /// table are written.
  template <typename Table>
  void complete(std::optional<Table>& table) {
    if (!table) return;
    table->check_complete();
    hdf5::naming(name, [&] { table->flush(); });
  }

  std::string name;
  bool is_empty;  ///< whether nothing collides
  hdf5::Id file;
  File output;  ///< a second handle of the same file
  bool has_last_pose;
  std::uint64_t synced = 0;  ///< bytes of the file that are on their way to the disk
  std::optional<CollisionTable> collisions;
  std::optional<ClearanceTable> clearances;
  std::optional<ProfileTable> profile;
};

ResultWriter::ResultWriter(const std::filesystem::path& path, const ResultHeader& header,
                           std::uint64_t collisions, std::uint64_t clearances)
    : state_(hdf5::naming(path.string(), [&] {
        return std::make_unique<State>(path, header, collisions, clearances);
      })) {}

ResultWriter::~ResultWriter() {
  const hdf5::QuietScope quiet;
  state_.reset();
}

void ResultWriter::append(std::span<const std::uint64_t> source, std::span<const Vec3> xyz,
                          std::span<const std::uint32_t> first_pose,
                          std::span<const std::uint32_t> body,
                          std::span<const std::uint32_t> last_pose) {
  State& s = *state_;
  hdf5::naming(s.name, [&] { s.collisions->append(source, xyz, first_pose, body, last_pose); });
}

void ResultWriter::append_clearances(std::span<const std::uint64_t> source,
                                     std::span<const Vec3> xyz, std::span<const double> distance,
                                     std::span<const std::uint32_t> pose,
                                     std::span<const std::uint32_t> body) {
  State& s = *state_;
  if (!s.clearances) throw std::logic_error("ResultWriter: no clearances");
  s.complete(s.collisions);
  hdf5::naming(s.name, [&] { s.clearances->append(source, xyz, distance, pose, body); });
}

void ResultWriter::append_profile(std::span<const double> distance,
                                  std::span<const std::uint64_t> source, std::span<const Vec3> xyz,
                                  std::span<const double> chainage,
                                  std::span<const double> squared) {
  State& s = *state_;
  if (!s.profile) throw std::logic_error("ResultWriter: no profile");
  s.complete(s.collisions);
  s.complete(s.clearances);
  hdf5::naming(s.name, [&] { s.profile->append(distance, source, xyz, chainage, squared); });
}

EncodedCollisions ResultWriter::new_collisions() const { return state_->collisions->new_rows(); }

EncodedClearances ResultWriter::new_clearances() const {
  if (!state_->clearances) throw std::logic_error("ResultWriter: no clearances");
  return state_->clearances->new_rows();
}

void ResultWriter::hash(const EncodedCollisions& rows) { state_->collisions->hash(rows); }
void ResultWriter::hash(const EncodedClearances& rows) { state_->clearances->hash(rows); }

void ResultWriter::write(EncodedCollisions& rows) {
  hdf5::naming(state_->name, [&] { state_->collisions->write(rows); });
  state_->written();
}

void ResultWriter::write(EncodedClearances& rows) {
  State& s = *state_;
  s.complete(s.collisions);
  hdf5::naming(s.name, [&] { s.clearances->write(rows); });
  s.written();
}

void ResultWriter::finish(const ResultFindings& findings) {
  State& s = *state_;
  s.complete(s.collisions);
  s.complete(s.clearances);
  s.complete(s.profile);
  hdf5::naming(s.name, [&] {
    hdf5::write_number(s.file, names::kCollisionsHash, s.collisions->hash(kHashedColumns));
    if (s.has_last_pose) {
      hdf5::write_number(s.file, names::kLastPoseHash, s.collisions->hash_of_last());
    }
    if (s.clearances) hdf5::write_number(s.file, names::kClearanceHash, s.clearances->hash());
    if (s.profile) hdf5::write_number(s.file, names::kProfileHash, s.profile->hash());
    write_result_findings(s.file, s.is_empty ? findings : without_doubts(findings));
    hdf5::write_number(s.file, "complete", std::uint8_t{1});
    s.collisions->write_held();
    if (s.clearances) s.clearances->write_held();
    if (s.profile) s.profile->write_held();
    hdf5::check(H5Fflush(s.file.get(), H5F_SCOPE_LOCAL), "write the result");
    // After the flush, closing has nothing left to write and cannot fail for a full disk.
    s.profile.reset();
    s.clearances.reset();
    s.collisions.reset();
    s.file.close("close the result");
  });
}

}  // namespace clearway
