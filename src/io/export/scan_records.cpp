#include "io/export/scan_records.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "io/formats/las/las_extra_bytes.hpp"
#include "io/formats/point_reader.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

constexpr std::size_t kWindowBytes = std::size_t{1} << 18;
constexpr std::uint16_t kBaseBytes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/// Size in bytes of a described field of extra bytes. Source: LAS 1.4 R15, table 24.
std::size_t field_bytes(const std::byte* description) {
  constexpr std::size_t kScalar[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  const auto type = std::to_integer<unsigned>(description[2]);
  if (type == 0) return std::to_integer<std::size_t>(description[3]);
  // Types of several values are deprecated.
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
    const auto description = las_extra_bytes("undocumented", LasExtraType::kUndocumented, "",
                                             static_cast<std::uint8_t>(field));
    out.insert(out.end(), description.begin(), description.end());
    covered += field;
  }
  return out;
}

bool starts_as_las(const std::filesystem::path& path) {
  InputBuffer input(File::open_regular(path), InputBuffer::Access::kSeek);
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

LasRecordFormat LasRecordReader::format() const {
  const std::size_t extra = header_.record_bytes - kBaseBytes[header_.point_format];
  return {.point_format = header_.point_format,
          .record_bytes = header_.record_bytes,
          .encoding = header_.encoding,
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

}  // namespace clearway
