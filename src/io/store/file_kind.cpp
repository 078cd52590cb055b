#include "io/store/file_kind.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "clearway/error.hpp"
#include "io/files/file.hpp"
#include "io/files/text_lines.hpp"
#include "io/files/text_number.hpp"
#include "io/result/journal.hpp"
#include "io/result/result.hpp"
#include "io/scans/point_formats.hpp"
#include "io/scans/text/text_table.hpp"
#include "io/section/section_file.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {
namespace {

constexpr std::size_t kLookedAt = 1 << 16;  ///< bytes that are examined

/// Describes an HDF5 file by its attribute `format`, which is written first.
FileDescription describe_hdf5(std::string_view bytes) {
  const auto is = [&](const TableFileKind& kind) {
    return bytes.find(kind.format) != std::string_view::npos;
  };
  if (std::ranges::any_of(kResultKinds, is)) return {FileKind::kResult, "a result"};
  if (is(kSectionKind)) return {FileKind::kSection, "a section"};
  if (is(kStoreKind)) return {FileKind::kStore, "a store"};
  return {FileKind::kOtherHdf5, "an HDF5 file, but no sound store or result"};
}

/// Whether four numbers are a unit quaternion within the precision of printed numbers.
bool is_quaternion(std::span<const double> q) {
  const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  return std::abs(norm - 1) < 1e-3;
}

/// The kind of pose in a line of numbers, by their number and size; empty where it is not a pose.
std::string pose_words(std::span<const double> numbers) {
  const std::string count = std::to_string(numbers.size());
  if (numbers.size() == 12 || numbers.size() == 16) {
    return "a trajectory (" + count + " numbers a line)";
  }
  if ((numbers.size() == 7 || numbers.size() == 8) && is_quaternion(numbers.last(4))) {
    return "a trajectory (positions and quaternions)";
  }
  return "";
}

bool names_poses(std::string_view line) {
  const std::vector<std::string> names = parse_table_header(line).written;
  return std::ranges::any_of(names, [](const std::string& name) {
    return name == "qw" || name.ends_with("q_w") || name.ends_with("orientation.w") ||
           name.starts_with("q_rs_w") || name == "roll" || name == "r00";
  });
}

/// Describes a text file by its first line of numbers and a header before it.
FileDescription describe_text(std::string_view text) {
  std::array<double, 16> numbers{};
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    const auto count = parse_number_line(line, numbers);
    if (!count || *count > numbers.size()) {
      if (names_poses(line)) return {FileKind::kTrajectory, "a trajectory (with named columns)"};
      continue;
    }
    if (*count == 1) continue;  // a number of points
    const std::string words = pose_words(std::span(numbers).first(*count));
    if (!words.empty()) return {FileKind::kTrajectory, words};
    return {FileKind::kTextPoints,
            "a text of points (" + std::to_string(*count) + " numbers a line)"};
  }
  return {};
}

}  // namespace

std::string point_format_name(const std::filesystem::path& path) {
  const File file = File::open_for_reading(path);
  std::array<std::byte, 16> bytes{};
  const auto first =
      std::span(bytes).first(std::min<std::uint64_t>(bytes.size(), file.size_bytes()));
  file.read_at(0, first);
  auto format = format_of_content(first);
  if (!format) format = format_of_name(path);
  if (!format) return "text";
  switch (*format) {
    case PointFormat::kLas:
      return file_ending(path) == ".laz" ? "LAZ" : "LAS";
    case PointFormat::kPly:
      return "PLY";
    case PointFormat::kE57:
      return "E57";
    case PointFormat::kPcd:
      return "PCD";
    case PointFormat::kPtx:
      return "PTX";
    case PointFormat::k3dtk:
      return "3DTK";
    case PointFormat::kMesh:
    case PointFormat::kUnreadMesh:
      return "mesh";
    default:
      return "text";
  }
}

FileDescription describe_file(const std::filesystem::path& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) {
    if (!std::filesystem::exists(path, unknown)) {
      throw ResourceError(path.string() + ": no such file or folder");
    }
    return {};
  }
  const File file = File::open_regular(path);
  std::vector<std::byte> bytes(std::min<std::uint64_t>(kLookedAt, file.size_bytes()));
  file.read_at(0, bytes);
  if (bytes.empty()) return {FileKind::kEmpty, "empty"};
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\x89HDF")) return describe_hdf5(text.substr(0, 1024));
  if (is_journal(path))
    return {FileKind::kJournal, "the journal of an unfinished run or conversion"};
  if (format_of_content(std::span(bytes).first(std::min<std::size_t>(16, bytes.size())))) {
    return {FileKind::kPoints, "a scan (" + point_format_name(path) + ")"};
  }
  const auto named = format_of_name(path);
  if (named == PointFormat::kMesh || named == PointFormat::kUnreadMesh) {
    return {FileKind::kMesh, "a mesh"};
  }
  if (text.find('\0') != std::string_view::npos) return {};
  if (named && *named != PointFormat::kXyz) {
    return {FileKind::kTextPoints, "a scan (" + point_format_name(path) + ")"};
  }
  return describe_text(text);
}

}  // namespace clearway
