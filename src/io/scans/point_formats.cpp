#include "io/scans/point_formats.hpp"

#include <string_view>
#include <vector>

#include "io/files/file.hpp"
#include "io/files/input_error.hpp"

namespace clearway {
namespace {

struct Ending {
  std::string_view ending;
  PointFormat format;
  bool only_points;  ///< files with this ending hold points and nothing else
};

constexpr Ending kEndings[] = {
    {".las", PointFormat::kLas, true},         {".laz", PointFormat::kLas, true},
    {".ply", PointFormat::kPly, true},         {".xyz", PointFormat::kXyz, true},
    {".pts", PointFormat::kXyz, true},         {".asc", PointFormat::kXyz, true},
    {".txt", PointFormat::kXyz, false},        {".csv", PointFormat::kXyz, false},
    {".e57", PointFormat::kE57, true},         {".pcd", PointFormat::kPcd, true},
    {".ptx", PointFormat::kPtx, true},         {".3d", PointFormat::k3dtk, true},
    {".obj", PointFormat::kMesh, false},       {".stl", PointFormat::kMesh, false},
    {".off", PointFormat::kMesh, false},       {".gltf", PointFormat::kUnreadMesh, false},
    {".glb", PointFormat::kUnreadMesh, false}, {".dae", PointFormat::kUnreadMesh, false}};

const Ending* ending_of(const std::filesystem::path& path) {
  const std::string ending = file_ending(path);
  for (const Ending& known : kEndings) {
    if (known.ending == ending) return &known;
  }
  return nullptr;
}

}  // namespace

std::optional<PointFormat> format_of_content(std::span<const std::byte> first_bytes) {
  const std::string_view text(reinterpret_cast<const char*>(first_bytes.data()),
                              first_bytes.size());
  if (text.starts_with("LASF")) return PointFormat::kLas;
  if (text.starts_with("ASTM-E57")) return PointFormat::kE57;
  if (text.starts_with("# .PCD")) return PointFormat::kPcd;
  if (text.size() > 3 && text.starts_with("ply") &&
      std::string_view(" \t\r\n").find(text[3]) != std::string_view::npos) {
    return PointFormat::kPly;
  }
  return std::nullopt;
}

std::optional<PointFormat> format_of_name(const std::filesystem::path& path) {
  const Ending* ending = ending_of(path);
  return ending ? std::optional(ending->format) : std::nullopt;
}

bool is_surely_point_file(const std::filesystem::path& path) {
  const Ending* ending = ending_of(path);
  return ending && ending->only_points;
}

std::string sure_endings() {
  std::vector<std::string_view> endings;
  for (const Ending& known : kEndings) {
    if (known.only_points) endings.push_back(known.ending.substr(1));
  }
  std::string text;
  for (std::size_t i = 0; i < endings.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == endings.size() ? " or " : ", ") + std::string(endings[i]);
  }
  return text;
}

void refuse_unless_read(PointFormat format, const std::string& name) {
  switch (format) {
    case PointFormat::kMesh:
      refuse(name, "a mesh is read as a model alone; expected points", Remedy::kSampleMesh);
    case PointFormat::kUnreadMesh:
      refuse(name,
             "a mesh in a format that is not read; expected points. Export the mesh as STL, OBJ or "
             "PLY first",
             Remedy::kSampleMesh);
    case PointFormat::kE57:
    case PointFormat::kLas:
    case PointFormat::kPly:
    case PointFormat::kXyz:
    case PointFormat::kPcd:
    case PointFormat::kPtx:
    case PointFormat::k3dtk:
      break;
  }
}

}  // namespace clearway
