#include "io/models/mesh/mesh_writer.hpp"

#include <string>

#include "clearway/error.hpp"
#include "io/files/file.hpp"
#include "io/files/text_writer.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {
void check_mesh_name(const std::filesystem::path& path) {
  const std::string ending = file_ending(path);
  if (ending == ".off" || ending == ".ply") return;
  throw UsageError(path.string() + ": expected a name that ends in .off or .ply, for a mesh");
}

void write_mesh(const Model& model, const std::filesystem::path& path, const File& file) {
  check_mesh_name(path);
  TextWriter out(file);
  if (file_ending(path) == ".off") {
    out << "OFF\n# " << kUnitComment << "m\n"
        << model.vertices.size() << " " << model.triangles.size() << " 0\n";
  } else {
    out << "ply\nformat ascii 1.0\ncomment " << kUnitComment << "m\nelement vertex "
        << model.vertices.size()
        << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
        << model.triangles.size() << "\nproperty list uchar uint vertex_indices\nend_header\n";
  }
  for (const Vec3& p : model.vertices) out << p.x << " " << p.y << " " << p.z << "\n";
  for (const auto& [a, b, c] : model.triangles) {
    out << "3 " << a << " " << b << " " << c << "\n";
  }
  out.flush();
}

}  // namespace clearway
