#include "io/export/export_scan_records.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "clearway/error.hpp"
#include "io/export/row_sink.hpp"
#include "io/export/scan_records.hpp"
#include "io/formats/byte_load.hpp"
#include "io/formats/las/las_extra_bytes.hpp"
#include "io/formats/requantize.hpp"
#include "io/result/result.hpp"
#include "io/system/input_error.hpp"
#include "io/system/pending_file.hpp"

namespace clearway {
namespace {

constexpr double kNoDistance = -1;
constexpr const char* kNotTheScans = "these are not the scans of this result";
constexpr std::uint16_t kGpsTimeBit = 1;

std::vector<std::filesystem::path> paths_of(const std::vector<ScanFile>& files) {
  std::vector<std::filesystem::path> paths;
  paths.reserve(files.size());
  for (const ScanFile& file : files) paths.push_back(file.path);
  return paths;
}

void check_points(const std::vector<ScanFile>& files, const ResultReader& result) {
  const std::uint64_t points = files.empty() ? 0 : files.back().end();
  if (points == result.header().environment_points) return;
  throw InputError("the scans have " + std::to_string(points) + " points, the environment of " +
                   result.name() + " has " + std::to_string(result.header().environment_points) +
                   ": " + kNotTheScans +
                   ". Give the files and folders that were converted, in the same order");
}

/// Numbers of colliding points in each file.
std::vector<std::uint64_t> collisions_of(const std::vector<ScanFile>& files,
                                         const ResultReader& result, const Progress& progress) {
  std::vector<std::uint64_t> counts(files.size());
  std::size_t at = 0;
  RowStream<Collisions> stream(result);
  for (Collisions rows; stream.read(rows);) {
    throw_if_stopped(progress);
    for (const std::uint64_t source : rows.source) {
      while (source >= files[at].end()) ++at;
      ++counts[at];
    }
  }
  return counts;
}

void check_can_copy(const ScanFile& file, std::uint64_t points) {
  if (file.is_las) return;
  const std::string many = std::to_string(points) + " of the points to copy are in it";
  if (file.is_laz) {
    refuse(file.path.string(), "its records are compressed (LAZ), and " + many +
                                   ". Only records of uncompressed LAS are copied: decompress it "
                                   "first, its points stay the same");
  }
  refuse(file.path.string(), "is no LAS file, and " + many +
                                 ". Only records of LAS are copied: export without the scans");
}

/// The common format of all records, or that of an empty file where nothing is copied.
class CommonFormat {
 public:
  void add(const LasRecordReader& scan) {
    const LasRecordFormat format = scan.format();
    if (format.point_format == 4 || format.point_format == 5 || format.point_format == 9 ||
        format.point_format == 10) {
      refuse(scan.name(), "its records (point format " + std::to_string(format.point_format) +
                              ") refer to waveforms, which are not copied; expected another point "
                              "format");
    }
    if (first_.empty()) {
      first_ = scan.name();
      format_ = format;
      return;
    }
    if (description(format) == description(format_) && format.extra_bytes == format_.extra_bytes) {
      return;
    }
    refuse(scan.name(), "has " + description(format) + ", but " + first_ + " has " +
                            description(format_) +
                            "; expected records of one kind, with the same extra bytes, as a LAS "
                            "file holds one kind. Bring the scans into one point format first");
  }

  const LasRecordFormat& get() const { return format_; }

 private:
  static std::string description(const LasRecordFormat& format) {
    return "point format " + std::to_string(format.point_format) + " in records of " +
           std::to_string(format.record_bytes) + " bytes with " +
           ((format.encoding & kGpsTimeBit) != 0 ? "adjusted GPS time" : "GPS week time");
  }

  std::string first_;
  LasRecordFormat format_;
};

/// A point's record followed by extra bytes with its result.
class ExtendedRecord {
 public:
  ExtendedRecord(const ResultReader& result, LasRecordFormat& format)
      : first_pose_(result.header().first_pose),
        body_(result.header().has_first_bodies()),
        own_bytes_(format.record_bytes) {
    if (first_pose_) {
      add_field(format, sizeof(std::uint32_t),
                las_extra_bytes("first_pose", LasExtraType::kUint32, "first pose that touches"));
    }
    if (body_) {
      add_field(format, sizeof(std::uint32_t),
                las_extra_bytes("body", LasExtraType::kUint32, "body that touches first"));
    }
    if (result.header().clearance > 0) {
      distances_.emplace(result);
      add_field(format, sizeof(double),
                las_extra_bytes("distance", "least distance to the model", kNoDistance));
    }
    bytes_.resize(format.record_bytes);
  }

  std::span<const std::byte> of(std::span<const std::byte> record,
                                const std::array<std::int32_t, 3>& q, const CollisionCursor& row) {
    std::memcpy(bytes_.data(), record.data(), own_bytes_);
    std::memcpy(bytes_.data(), q.data(), sizeof q);
    std::byte* out = bytes_.data() + own_bytes_;
    if (first_pose_) {
      const std::uint32_t pose = row.get(&Collisions::first_pose);
      std::memcpy(out, &pose, sizeof pose);
      out += sizeof pose;
    }
    if (body_) {
      const std::uint32_t body = row.get(&Collisions::body);
      std::memcpy(out, &body, sizeof body);
      out += sizeof body;
    }
    if (!distances_) return bytes_;
    const double distance = distance_of(row.source());
    std::memcpy(out, &distance, sizeof distance);
    return bytes_;
  }

  /// Reads the clearances to their end, where the file's hash is checked.
  void finish() {
    while (distances_ && !distances_->at_end()) distances_->advance();
  }

 private:
  static void add_field(LasRecordFormat& format, std::size_t bytes,
                        const LasExtraDescription& description) {
    constexpr std::size_t kMost = std::numeric_limits<std::uint16_t>::max();
    if (format.record_bytes + bytes > kMost ||
        format.extra_bytes.size() + description.size() > kMost) {
      throw InputError(
          "the scans' records are too long to get another field; expected fewer than "
          "65,524 bytes and 340 fields of extra bytes");
    }
    format.record_bytes = static_cast<std::uint16_t>(format.record_bytes + bytes);
    format.extra_bytes.insert(format.extra_bytes.end(), description.begin(), description.end());
  }

  double distance_of(std::uint64_t source) {
    while (!distances_->at_end() && distances_->source() < source) distances_->advance();
    return !distances_->at_end() && distances_->source() == source
               ? distances_->get(&Clearances::distance)
               : kNoDistance;
  }

  bool first_pose_, body_;
  std::size_t own_bytes_;
  std::optional<ClearanceCursor> distances_;
  std::vector<std::byte> bytes_;
};

std::string place_text(const Vec3& p) { return shown(p.x) + " " + shown(p.y) + " " + shown(p.z); }

/// The result's integers of a point. Throws InputError unless they are what the conversion made of
/// the record.
std::array<std::int32_t, 3> checked_place(const ResultReader& result, const LasRecordReader& scan,
                                          std::uint64_t point, std::span<const std::byte> record,
                                          const CollisionCursor& row) {
  const Quantisation& quantisation = result.header().quantisation;
  const Quantisation& own = scan.header().quantisation;
  const bool same_scale = own == quantisation;
  std::array<std::int32_t, 3> out{};
  Vec3 found{};
  bool equal = true;
  for (int k = 0; k < 3; ++k) {
    const auto q = load<std::int32_t>(record.data() + 4 * k);
    found[k] = coordinate(own, k, q);
    const double expected = row.get(&Collisions::xyz)[k];
    // The coordinate was rounded to the result's scale, where this differs.
    const double most = std::abs(quantisation.scale[k]) * (0.5 + 1e-6) +
                        8 * std::numeric_limits<double>::epsilon() * std::abs(expected);
    equal &= same_scale ? found[k] == expected : std::abs(found[k] - expected) <= most;
    const auto whole = quantum_at(quantisation, k, expected);
    if (!whole) {
      refuse(result.name(), "a coordinate of source point " + std::to_string(row.source()) +
                                " is not on the environment's scale");
    }
    out[static_cast<std::size_t>(k)] = same_scale ? q : *whole;
  }
  if (equal) return out;
  refuse(scan.name(), "point " + std::to_string(point) + " (source index " +
                          std::to_string(row.source()) + ") is at " + place_text(found) +
                          ", but at " + place_text(row.get(&Collisions::xyz)) + " in " +
                          result.name() + ": " + kNotTheScans +
                          ". Give the files and folders that were converted, in the same order");
}

void copy_records(const ResultReader& result, const std::vector<ScanFile>& files,
                  LasRecordFormat format, const File& out, Progress& progress) {
  format.quantisation = result.header().quantisation;
  format.crs_wkt = result.header().crs_wkt;
  ExtendedRecord extended(result, format);
  LasRecordWriter writer(out, format);
  std::optional<LasRecordReader> scan;
  std::size_t file = 0;
  for (CollisionCursor row(result); !row.at_end(); row.advance()) {
    while (row.source() >= files[file].end()) {
      ++file;
      scan.reset();
    }
    if (!scan) scan.emplace(files[file].path);
    throw_if_stopped(progress);
    const std::uint64_t point = row.source() - files[file].first;
    const auto record = scan->record(point);
    writer.write(extended.of(record, checked_place(result, *scan, point, record, row), row));
    progress.advance(1);
  }
  extended.finish();
  writer.finish();
}

}  // namespace

void export_scan_records(const ResultReader& result,
                         const std::vector<std::filesystem::path>& scans,
                         const std::filesystem::path& output, bool overwrite, Progress& progress) {
  if (export_format_of(output) != ExportFormat::kLas) {
    throw UsageError(output.string() + ": records of scans are copied to .las only");
  }
  const std::vector<ScanFile> files = number_scans(scans, progress);
  std::vector<std::filesystem::path> inputs = paths_of(files);
  inputs.emplace_back(result.name());
  refuse_overwriting(output, inputs);
  check_points(files, result);
  const std::vector<std::uint64_t> counts = collisions_of(files, result, progress);
  CommonFormat format;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (counts[i] == 0) continue;
    check_can_copy(files[i], counts[i]);
    format.add(LasRecordReader(files[i].path));
  }
  PendingFile pending(output, overwrite);
  {
    const File file = File::create(pending.partial());
    progress.begin("export", result.collisions(), "points");
    copy_records(result, files, format.get(), file, progress);
    progress.end();
  }
  pending.publish();
}

}  // namespace clearway
