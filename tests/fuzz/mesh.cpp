// Any bytes, read as a mesh and sampled; the first byte chooses the format.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/geometry/point_box.hpp"
#include "io/models/mesh/mesh_reader.hpp"
#include "io/models/mesh_facts.hpp"
#include "io/models/sample_mesh.hpp"
#include "memory_file.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Samples at a spacing that needs few points, however large or small the mesh.
void sample(const TriangleMesh& mesh) {
  const Box box = box_of(mesh.vertices);
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max(size, box.hi[k] - box.lo[k]);
  if (mesh.triangles.empty() || mesh.triangles.size() > 200 || !(size > 1e-6 && size < 1e8)) return;
  const double spacing = size / 16;
  const std::vector<Vec3> points = sample_mesh(mesh, spacing, "mesh");
  const auto far = [&](const Vec3& p) {
    return std::none_of(points.begin(), points.end(), [&](const Vec3& q) {
      return std::hypot(p.x - q.x, p.y - q.y, p.z - q.z) <= spacing;
    });
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    Vec3 middle{};
    for (int k = 0; k < 3; ++k) {
      middle[k] = (mesh.vertices[a][k] + mesh.vertices[b][k] + mesh.vertices[c][k]) / 3;
    }
    if (far(mesh.vertices[a]) || far(middle)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr MeshFormat kFormats[] = {MeshFormat::kStl, MeshFormat::kObj, MeshFormat::kOff,
                                     MeshFormat::kPly};
  const MemoryFile input({data + 1, size - 1});
  may_refuse([&] {
    const MeshFile read = read_mesh(InputBuffer(input.open(), InputBuffer::Access::kSeek),
                                    kFormats[data[0] % std::size(kFormats)]);
    for (const Vec3& vertex : read.mesh.vertices) {
      for (int k = 0; k < 3; ++k) {
        if (!std::isfinite(vertex[k])) std::abort();
      }
    }
    for (const auto& triangle : read.mesh.triangles) {
      for (const std::uint32_t corner : triangle) {
        if (corner >= read.mesh.vertices.size()) std::abort();
      }
    }
    facts_of(read.mesh);
    if (!read.mesh.vertices.empty()) sample(read.mesh);
  });
  return 0;
}
