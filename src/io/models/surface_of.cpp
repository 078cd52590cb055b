#include "io/models/surface_of.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "clearway/error.hpp"
#include "core/messages/messages.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"

namespace clearway {
namespace {

using Corners = std::array<std::uint32_t, 3>;

/// Removes the vertices that no triangle uses and returns their number.
std::uint64_t remove_unused(TriangleMesh& mesh) {
  constexpr std::uint32_t kUnused = 0xffffffff;
  std::vector<std::uint32_t> number(mesh.vertices.size(), kUnused);
  for (const Corners& t : mesh.triangles) {
    for (const std::uint32_t corner : t) number[corner] = 0;
  }
  std::uint32_t used = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == kUnused) continue;
    number[i] = used;
    mesh.vertices[used++] = mesh.vertices[i];
  }
  for (Corners& t : mesh.triangles) {
    for (std::uint32_t& corner : t) corner = number[corner];
  }
  const std::uint64_t unused = mesh.vertices.size() - used;
  mesh.vertices.resize(used);
  return unused;
}

}  // namespace

TriangleMesh kept_surface(const ModelInput& input, std::vector<Message>& messages) {
  TriangleMesh mesh = input.mesh;
  if (const std::uint64_t unused = remove_unused(mesh); unused > 0) {
    messages.push_back(loose_vertices_warning(input, unused));
  }
  return mesh;
}

TriangleMesh surface_of(const ModelInput& input, const ModelOptions& options,
                        std::vector<Message>& messages) {
  messages.insert(messages.end(), input.messages.begin(), input.messages.end());
  if (!input.is_mesh()) {
    refuse(input.path.string(), "has no triangles; expected a mesh, whose surface is searched",
           Remedy::kModelPoints);
  }
  messages.push_back(
      plain_note(input.path.string() + ": a mesh of " + contents_of(input) + ", searched as it is",
                 {{"triangles", input.mesh.triangles.size()}}));
  if (options.radius > 0) {
    tell_bend(input, default_spacing(options.radius), "the spacing that points would have",
              messages);
  }
  return kept_surface(input, messages);
}

}  // namespace clearway
