#include "io/formats/point_formats.hpp"

#include <string_view>

#include "io/system/input_error.hpp"

namespace clearway {
namespace {

struct Ending {
  std::string_view ending;
  PointFormat format;
  bool only_points;  ///< files with this ending hold points and nothing else
};

constexpr Ending kEndings[] = {
    {".las", PointFormat::kLas, true},   {".laz", PointFormat::kLas, true},
    {".ply", PointFormat::kPly, true},   {".xyz", PointFormat::kXyz, true},
    {".pts", PointFormat::kXyz, true},   {".asc", PointFormat::kXyz, true},
    {".txt", PointFormat::kXyz, false},  {".csv", PointFormat::kXyz, false},
    {".e57", PointFormat::kE57, true},   {".pcd", PointFormat::kPcd, true},
    {".ptx", PointFormat::kPtx, true},   {".3d", PointFormat::k3dtk, true},
    {".obj", PointFormat::kMesh, false}, {".stl", PointFormat::kMesh, false},
    {".off", PointFormat::kMesh, false}, {".gltf", PointFormat::kMesh, false},
    {".glb", PointFormat::kMesh, false}, {".dae", PointFormat::kMesh, false}};

const Ending* ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  for (const Ending& known : kEndings) {
    if (known.ending == ending) return &known;
  }
  return nullptr;
}

[[noreturn]] void refuse_format(const std::string& name, const char* format) {
  refuse(name, std::string(format) +
                   " is not read; expected LAS, PLY or XYZ text. Convert it to LAS or PLY, for "
                   "example with PDAL or CloudCompare");
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

void refuse_unless_read(PointFormat format, const std::string& name) {
  switch (format) {
    case PointFormat::kE57:
      refuse_format(name, "E57");
    case PointFormat::kPcd:
      refuse_format(name, "PCD");
    case PointFormat::kPtx:
      refuse_format(name, "PTX");
    case PointFormat::k3dtk:
      refuse_format(name, "a 3DTK scan");
    case PointFormat::kMesh:
      refuse(name,
             "a mesh is read as a model alone; expected points in LAS, PLY or XYZ text. `clearway "
             "model` samples its surface to points in PLY");
    case PointFormat::kLas:
    case PointFormat::kPly:
    case PointFormat::kXyz:
      break;
  }
}

}  // namespace clearway
