#include "io/result/export/export_scan_records.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/files/bytes.hpp"
#include "io/files/input_error.hpp"
#include "io/files/pending_file.hpp"
#include "io/result/export/export_result.hpp"
#include "io/result/result.hpp"
#include "io/scans/las/las_header.hpp"
#include "io/scans/point_reader.hpp"
#include "io/scans/requantize.hpp"

namespace clearway {
namespace {

constexpr std::size_t kWindowBytes = std::size_t{1} << 18;
constexpr std::uint16_t kBaseBytes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/// Size in bytes of a described field of extra bytes. Source: LAS 1.4 R15, table 24.
std::size_t field_bytes(const std::byte* description) {
  constexpr std::size_t kScalar[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  const auto type = std::to_integer<unsigned>(description[2]);
  if (type == 0) return std::to_integer<std::size_t>(description[3]);
  // Types 11 to 30 have two or three values; LAS 1.4 calls them deprecated.
  const std::size_t values = type <= 10 ? 1 : type <= 20 ? 2 : 3;
  return type > 30 ? 0 : values * kScalar[(type - 1) % 10 + 1];
}

/// Descriptions of exactly `bytes` extra bytes: those of `found` as far as they fit, and
/// "undocumented" ones for the rest.
std::vector<std::byte> described(std::span<const std::byte> found, std::size_t bytes) {
  std::vector<std::byte> out;
  std::size_t covered = 0;
  for (; found.size() >= kLasExtraBytes; found = found.subspan(kLasExtraBytes)) {
    const std::size_t field = field_bytes(found.data());
    if (field == 0 || covered + field > bytes) break;
    out.insert(out.end(), found.begin(), found.begin() + kLasExtraBytes);
    covered += field;
  }
  while (covered < bytes) {
    const std::size_t field = std::min<std::size_t>(bytes - covered, 255);
    const auto description =
        las_extra_bytes("undocumented", 0, static_cast<std::uint8_t>(field), "");
    out.insert(out.end(), description.begin(), description.end());
    covered += field;
  }
  return out;
}

bool starts_as_las(const std::filesystem::path& path) {
  InputBuffer input = InputBuffer::open_regular(path);
  const auto start = input.peek(4);
  return start.size() == 4 && std::memcmp(start.data(), "LASF", 4) == 0;
}

std::uint64_t count_points(const std::filesystem::path& path, const Progress& progress) {
  const auto reader = open_point_file(path);
  std::uint64_t points = 0;
  for (PointBatch batch; reader->read(batch); points += batch.size()) throw_if_stopped(progress);
  return points;
}

}  // namespace

LasRecordReader::LasRecordReader(const std::filesystem::path& path)
    : input_(File::open_regular(path), InputBuffer::Access::kSeek),
      header_(read_las_header(input_)) {
  read_las_vlrs(input_, header_, records_);
}

LasFormat LasRecordReader::format() const {
  const std::size_t extra = header_.record_bytes - kBaseBytes[header_.point_format];
  return {.point_format = header_.point_format,
          .record_bytes = header_.record_bytes,
          .encoding = header_.encoding,
          .system = "EXTRACTION",
          .quantisation = header_.quantisation,
          .extra_bytes = described(records_.extra_bytes, extra),
          .crs_wkt = {},
          .geotiff = records_.geotiff};
}

std::span<const std::byte> LasRecordReader::record(std::uint64_t point) {
  const std::size_t bytes = header_.record_bytes;
  if (point < first_ || point >= first_ + count_) {
    first_ = point;
    count_ = std::min<std::uint64_t>(std::max<std::size_t>(1, kWindowBytes / bytes),
                                     header_.points - point);
    window_.resize(count_ * bytes);
    input_.read_at(header_.points_offset + first_ * bytes, window_);
  }
  return std::span(window_).subspan((point - first_) * bytes, bytes);
}

std::vector<ScanFile> number_scans(const std::vector<std::filesystem::path>& inputs,
                                   Progress& progress) {
  std::vector<ScanFile> files;
  std::uint64_t next = 0;
  for (const std::filesystem::path& path : list_point_files(inputs)) {
    throw_if_stopped(progress);
    ScanFile file{.path = path, .first = next};
    if (starts_as_las(path)) {
      const LasPublicHeader header = LasRecordReader(path).header();
      file.points = header.points;
      file.is_las = !header.compressed;
      file.is_laz = header.compressed;
    } else {
      file.points = count_points(path, progress);
    }
    // The count in a LAZ header is checked only when its points are read.
    if (file.points > std::numeric_limits<std::uint64_t>::max() - next) {
      refuse(path.string(), "declares " + std::to_string(file.points) +
                                " points; expected fewer than 2^64 in all scans");
    }
    next += file.points;
    files.push_back(std::move(file));
  }
  return files;
}

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
    const LasFormat format = scan.format();
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

  const LasFormat& get() const { return format_; }

 private:
  static std::string description(const LasFormat& format) {
    return "point format " + std::to_string(format.point_format) + " in records of " +
           std::to_string(format.record_bytes) + " bytes with " +
           ((format.encoding & kGpsTimeBit) != 0 ? "adjusted GPS time" : "GPS week time");
  }

  std::string first_;
  LasFormat format_;
};

/// A point's record followed by extra bytes with its result.
class ExtendedRecord {
 public:
  ExtendedRecord(const ResultReader& result, LasFormat& format)
      : header_(result.header()), own_bytes_(format.record_bytes) {
    for (const PointField& field : fields_of<Collisions>(header_)) {
      if (field.type != PointField::Type::kClass) format.add(field);  // which records have already
    }
    if (header_.clearance > 0) {
      distances_.emplace(result);
      format.add(
          {"distance", PointField::Type::kDouble, "least distance to the model", kNoDistance});
    }
    bytes_.resize(format.record_bytes);
  }

  std::span<const std::byte> of(std::span<const std::byte> record,
                                const std::array<std::int32_t, 3>& q, const CollisionCursor& row) {
    std::memcpy(bytes_.data(), record.data(), own_bytes_);
    std::memcpy(bytes_.data(), q.data(), sizeof q);
    std::byte* out = bytes_.data() + own_bytes_;
    const auto append = [&](const auto& value) {
      std::memcpy(out, &value, sizeof value);
      out += sizeof value;
    };
    for_each_column<Collisions>([&](const auto& column) {
      constexpr bool is_class = sizeof(typename std::decay_t<decltype(column)>::Value) == 1;
      if (column.field == nullptr || is_class || !column.is_in(header_)) return;
      append(row.get(column.values));
    });
    if (distances_) append(distance_of(row.source()));
    return bytes_;
  }

  /// Reads the clearances to their end, where the file's hash is checked.
  void finish() {
    while (distances_ && !distances_->at_end()) distances_->advance();
  }

 private:
  double distance_of(std::uint64_t source) {
    while (!distances_->at_end() && distances_->source() < source) distances_->advance();
    return !distances_->at_end() && distances_->source() == source
               ? distances_->get(&Clearances::distance)
               : kNoDistance;
  }

  const ResultHeader& header_;
  std::size_t own_bytes_;
  std::optional<ClearanceCursor> distances_;
  std::vector<std::byte> bytes_;
};

std::string place_text(const Vec3& p) {
  return format_number(p.x) + " " + format_number(p.y) + " " + format_number(p.z);
}

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

void copy_records(const ResultReader& result, const std::vector<ScanFile>& files, LasFormat format,
                  const File& out, Progress& progress) {
  format.quantisation = result.header().quantisation;
  format.crs_wkt = result.header().crs_wkt;
  ExtendedRecord extended(result, format);
  LasWriter writer(out, format);
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
