#include "io/models/mesh/mesh_reader.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "io/files/file.hpp"
#include "io/files/input_error.hpp"

namespace clearway {
namespace {

struct OtherFormat {
  std::string_view ending;
  const char* name;
};

constexpr OtherFormat kOtherFormats[] = {{".gltf", "glTF"},
                                         {".glb", "glTF"},
                                         {".dae", "COLLADA"},
                                         {".ifc", "IFC"},
                                         {".step", "STEP"},
                                         {".stp", "STEP"},
                                         {".iges", "IGES"},
                                         {".igs", "IGES"},
                                         {".fbx", "FBX"},
                                         {".3ds", "3DS"},
                                         {".dxf", "DXF"},
                                         {".dwg", "DWG"},
                                         {".x3d", "X3D"},
                                         {".wrl", "VRML"},
                                         {".3mf", "3MF"},
                                         {".blend", "Blender"},
                                         {".skp", "SketchUp"},
                                         {".usd", "USD"},
                                         {".usda", "USD"},
                                         {".usdc", "USD"},
                                         {".usdz", "USD"},
                                         {".jt", "JT"},
                                         {".amf", "AMF"},
                                         {".vtk", "VTK"},
                                         {".vtp", "VTK"},
                                         {".msh", "Gmsh"},
                                         {".sldprt", "SolidWorks"},
                                         {".rvt", "Revit"},
                                         {".3dm", "Rhino"},
                                         {".x_t", "Parasolid"},
                                         {".mtl", "a material of OBJ"}};

[[noreturn]] void refuse_format(const File& file, const char* format) {
  refuse(file.name(), std::string(format) +
                          " is not read; expected a mesh in STL, OBJ, PLY or OFF, or points. "
                          "Export the model as STL, OBJ or PLY");
}

std::optional<MeshFormat> format_of_text(std::string_view text) {
  if (text.size() > 3 && text.starts_with("ply") &&
      std::string_view(" \t\r\n").find(text[3]) != std::string_view::npos) {
    return MeshFormat::kPly;
  }
  for (const std::string_view off : {"OFF", "COFF", "NOFF", "STOFF", "CNOFF", "NCOFF", "4OFF"}) {
    if (text.starts_with(off)) return MeshFormat::kOff;
  }
  if (text.starts_with("solid")) return MeshFormat::kStl;
  return std::nullopt;
}

}  // namespace

std::optional<MeshFormat> mesh_format_of(const File& file, const std::filesystem::path& path) {
  if (!file.is_regular()) return std::nullopt;
  std::array<std::byte, 16> bytes{};
  const std::span<std::byte> first(bytes.data(),
                                   std::min<std::uint64_t>(bytes.size(), file.size_bytes()));
  file.read_at(0, first);
  const std::string_view text(reinterpret_cast<const char*>(first.data()), first.size());
  if (text.starts_with("glTF")) refuse_format(file, "glTF");
  if (text.starts_with("ISO-10303-21")) refuse_format(file, "STEP (also of IFC)");
  const std::string ending = file_ending(path);
  // Decided by the name, because a binary file may begin with any text.
  if (ending == ".stl") return MeshFormat::kStl;
  if (const auto format = format_of_text(text)) return format;
  if (ending == ".obj") return MeshFormat::kObj;
  if (ending == ".off") return MeshFormat::kOff;
  for (const OtherFormat& other : kOtherFormats) {
    if (other.ending == ending) refuse_format(file, other.name);
  }
  return std::nullopt;
}

MeshFile read_mesh(InputBuffer input, MeshFormat format) {
  switch (format) {
    case MeshFormat::kStl:
      return read_stl(std::move(input));
    case MeshFormat::kObj:
      return read_obj(std::move(input));
    case MeshFormat::kOff:
      return read_off(std::move(input));
    case MeshFormat::kPly:
      break;
  }
  return read_ply_mesh(std::move(input));
}

}  // namespace clearway
