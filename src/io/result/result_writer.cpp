#include <algorithm>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "clearway/error.hpp"
#include "io/hdf5/hdf5.hpp"
#include "io/result/as_numbers.hpp"
#include "io/result/column_hashes.hpp"
#include "io/result/result.hpp"
#include "io/result/result_names.hpp"

namespace clearway {
namespace {

namespace names = result_names;

/// A multiple of every dataset's chunk rows. The order of the writes, and with it every address in
/// the file, follows from it and the number of rows, not from how they were appended.
constexpr std::size_t kBufferRows = 1 << 16;

void write_header(const hdf5::Id& file, const ResultHeader& header) {
  hdf5::write_attribute(file, "format", std::string(names::kFormat));
  hdf5::write_number(file, "version", names::kVersion);
  hdf5::write_number(file, "environment_points", header.environment_points);
  hdf5::write_number(file, "environment_hash", header.environment_hash);
  hdf5::write_number(file, "model_points", header.model_points);
  hdf5::write_number(file, "model_hash", header.model_hash);
  hdf5::write_number(file, "poses", header.poses);
  hdf5::write_number(file, "trajectory_hash", header.trajectory_hash);
  hdf5::write_number(file, "radius", header.radius);
  hdf5::write_number(file, "first_pose", static_cast<std::uint8_t>(header.first_pose));
  hdf5::write_number(file, "clearance", header.clearance);
  hdf5::write_number(file, "between_poses", static_cast<std::uint8_t>(header.between_poses));
  hdf5::write_attribute(file, "scale", std::span<const double>(header.quantisation.scale));
  hdf5::write_attribute(file, "offset", std::span<const double>(header.quantisation.offset));
  hdf5::write_attribute(file, "crs_wkt", header.crs_wkt);
  if (header.tolerance > 0) {
    hdf5::write_number(file, names::kTolerance, header.tolerance);
    hdf5::write_attribute(file, names::kEngine, header.engine);
  }
  if (header.float_precision) hdf5::write_attribute(file, names::kPrecision, names::kFloat);
  if (header.has_poses_of_ways() && !header.ways_without_ends) {
    hdf5::write_attribute(file, names::kFirstPoseOf, names::kClosedWay);
  }
}

/// The piece of a column; a column that the result does not have stays empty.
template <typename Value>
std::span<const Value> piece(std::span<const Value> values, std::size_t from, std::size_t count) {
  return values.empty() ? values : values.subspan(from, count);
}

/// Rows promised and delivered, ascending by source.
class RowCount {
 public:
  explicit RowCount(std::uint64_t promised) : promised_(promised) {}

  void add(std::span<const std::uint64_t> source) {
    if (source.size() > promised_ - rows_) {
      throw std::logic_error("ResultWriter: more rows than promised");
    }
    for (const std::uint64_t index : source) {
      if (last_source_ && index <= *last_source_) {
        throw std::logic_error("ResultWriter: rows not ascending by source");
      }
      last_source_ = index;
    }
    rows_ += source.size();
  }

  void check_complete() const {
    if (rows_ == promised_) return;
    throw std::logic_error("ResultWriter: " + std::to_string(rows_) + " rows written, " +
                           std::to_string(promised_) + " promised");
  }

 private:
  std::uint64_t promised_;
  std::uint64_t rows_ = 0;
  std::optional<std::uint64_t> last_source_;
};

/// A dataset and its rows not yet written, at most kBufferRows.
template <typename Number, typename Value = Number>
struct Column {
  Column(const hdf5::Id& group, const char* name, std::uint64_t rows)
      : dataset(group, name, rows, std::is_same_v<Value, Vec3> ? 3 : 0) {}

  void append(std::span<const Value> values) {
    buffer.insert(buffer.end(), values.begin(), values.end());
  }

  void flush(std::uint64_t first_row) {
    hash.update(std::as_bytes(std::span<const Value>(buffer)));
    if constexpr (std::is_same_v<Value, Vec3>) {
      dataset.write(first_row, as_numbers(std::span<const Vec3>(buffer)));
    } else {
      dataset.write(first_row, buffer);
    }
    buffer.clear();
  }

  hdf5::Rows<Number> dataset;
  std::vector<Value> buffer;
  Xxh64Stream hash;  ///< of the rows written
};

struct CollisionTable {
  CollisionTable(const hdf5::Id& file, bool with_first_pose, std::uint64_t rows)
      : group(hdf5::create_group(file, names::kGroup)),
        count(rows),
        source(group, names::kSource, rows),
        xyz(group, names::kXyz, rows) {
    if (with_first_pose) first_pose.emplace(group, names::kFirstPose, rows);
  }

  void append(std::span<const std::uint64_t> sources, std::span<const Vec3> points,
              std::span<const std::uint32_t> poses) {
    source.append(sources);
    xyz.append(points);
    if (first_pose) first_pose->append(poses);
  }

  void flush() {
    const std::size_t rows = source.buffer.size();
    source.flush(written);
    xyz.flush(written);
    if (first_pose) first_pose->flush(written);
    written += rows;
  }

  std::uint64_t hash() const {
    ColumnHashes hashes;
    hashes.add_digest(source.hash.digest());
    hashes.add_digest(xyz.hash.digest());
    if (first_pose) hashes.add_digest(first_pose->hash.digest());
    return hashes.digest();
  }

  hdf5::Id group;
  RowCount count;
  Column<std::uint64_t> source;
  Column<double, Vec3> xyz;
  std::optional<Column<std::uint32_t>> first_pose;
  std::uint64_t written = 0;
};

struct ClearanceTable {
  ClearanceTable(const hdf5::Id& file, std::uint64_t rows)
      : group(hdf5::create_group(file, names::kClearanceGroup)),
        count(rows),
        source(group, names::kSource, rows),
        distance(group, names::kDistance, rows),
        pose(group, names::kPose, rows) {}

  void append(std::span<const std::uint64_t> sources, std::span<const double> distances,
              std::span<const std::uint32_t> poses) {
    source.append(sources);
    distance.append(distances);
    pose.append(poses);
  }

  void flush() {
    const std::size_t rows = source.buffer.size();
    source.flush(written);
    distance.flush(written);
    pose.flush(written);
    written += rows;
  }

  std::uint64_t hash() const {
    ColumnHashes hashes;
    hashes.add_digest(source.hash.digest());
    hashes.add_digest(distance.hash.digest());
    hashes.add_digest(pose.hash.digest());
    return hashes.digest();
  }

  hdf5::Id group;
  RowCount count;
  Column<std::uint64_t> source;
  Column<double> distance;
  Column<std::uint32_t> pose;
  std::uint64_t written = 0;
};

/// Appends rows to a table's buffers and writes these whenever they are full.
template <typename Table, typename Value>
void append_rows(Table& table, const std::string& file, std::span<const std::uint64_t> source,
                 std::span<const Value> values, std::span<const std::uint32_t> poses) {
  table.count.add(source);
  for (std::size_t from = 0; from < source.size();) {
    const std::size_t count =
        std::min(source.size() - from, kBufferRows - table.source.buffer.size());
    table.append(source.subspan(from, count), values.subspan(from, count),
                 piece(poses, from, count));
    from += count;
    if (table.source.buffer.size() == kBufferRows) hdf5::naming(file, [&] { table.flush(); });
  }
}

}  // namespace

struct ResultWriter::State {
  State(const std::filesystem::path& path, const ResultHeader& header, std::uint64_t rows,
        std::uint64_t clearance_rows)
      : name(path.string()),
        has_first_pose(header.first_pose),
        file(hdf5::create_file(path)),
        collisions(std::in_place, file, header.first_pose, rows) {
    if (header.clearance > 0) clearances.emplace(file, clearance_rows);
    write_header(file, header);
  }

  std::string name;
  bool has_first_pose;
  hdf5::Id file;
  std::optional<CollisionTable> collisions;
  std::optional<ClearanceTable> clearances;
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
                          std::span<const std::uint32_t> first_pose) {
  State& s = *state_;
  if (xyz.size() != source.size() || first_pose.size() != (s.has_first_pose ? source.size() : 0)) {
    throw std::logic_error("ResultWriter: rows of unequal lengths");
  }
  append_rows(*s.collisions, s.name, source, xyz, first_pose);
}

void ResultWriter::append_clearances(std::span<const std::uint64_t> source,
                                     std::span<const double> distance,
                                     std::span<const std::uint32_t> pose) {
  State& s = *state_;
  if (!s.clearances) throw std::logic_error("ResultWriter: no clearances");
  if (distance.size() != source.size() || pose.size() != source.size()) {
    throw std::logic_error("ResultWriter: rows of unequal lengths");
  }
  s.collisions->count.check_complete();
  if (!s.collisions->source.buffer.empty()) hdf5::naming(s.name, [&] { s.collisions->flush(); });
  append_rows(*s.clearances, s.name, source, distance, pose);
}

void ResultWriter::finish() {
  State& s = *state_;
  s.collisions->count.check_complete();
  if (s.clearances) s.clearances->count.check_complete();
  hdf5::naming(s.name, [&] {
    s.collisions->flush();
    if (s.clearances) s.clearances->flush();
    hdf5::write_number(s.file, names::kCollisionsHash, s.collisions->hash());
    if (s.clearances) hdf5::write_number(s.file, names::kClearanceHash, s.clearances->hash());
    hdf5::write_number(s.file, "complete", std::uint8_t{1});
    hdf5::check(H5Fflush(s.file.get(), H5F_SCOPE_LOCAL), "write the result");
    // After the flush nothing is left that closing could fail to write.
    s.clearances.reset();
    s.collisions.reset();
    s.file.close("close the result");
  });
}

}  // namespace clearway
