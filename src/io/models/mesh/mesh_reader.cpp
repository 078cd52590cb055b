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

/// Formats of meshes and drawings that are not read, with the endings of their names.
constexpr struct {
  std::string_view endings;
  const char* name;
} kOtherFormats[] = {
    {" .gltf .glb ", "glTF"}, {" .dae ", "COLLADA"},       {" .ifc ", "IFC"},
    {" .step .stp ", "STEP"}, {" .iges .igs ", "IGES"},    {" .fbx ", "FBX"},
    {" .3ds ", "3DS"},        {" .dxf ", "DXF"},           {" .dwg ", "DWG"},
    {" .x3d ", "X3D"},        {" .wrl ", "VRML"},          {" .3mf ", "3MF"},
    {" .blend ", "Blender"},  {" .skp ", "SketchUp"},      {" .usd .usda .usdc .usdz ", "USD"},
    {" .jt ", "JT"},          {" .amf ", "AMF"},           {" .vtk .vtp ", "VTK"},
    {" .msh ", "Gmsh"},       {" .sldprt ", "SolidWorks"}, {" .rvt ", "Revit"},
    {" .3dm ", "Rhino"},      {" .x_t ", "Parasolid"},     {" .mtl ", "a material of OBJ"}};

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
  for (const auto& [endings, name] : kOtherFormats) {
    if (endings.find(" " + ending + " ") != std::string_view::npos) refuse_format(file, name);
  }
  return std::nullopt;
}

MeshFile read_mesh(InputBuffer input, MeshFormat format) {
  constexpr MeshFile (*kReaders[])(InputBuffer) = {read_stl, read_obj, read_off, read_ply_mesh};
  return kReaders[static_cast<std::size_t>(format)](std::move(input));
}

}  // namespace clearway
