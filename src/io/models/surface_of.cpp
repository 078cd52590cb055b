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

/// Cuts triangles at a height and keeps what is above. Triangles that share an edge share the point
/// where it is cut.
class HeightCut {
 public:
  HeightCut(const TriangleMesh& mesh, double above) : above_(above), out_{mesh.vertices, {}} {
    for (const Corners& triangle : mesh.triangles) add(triangle);
  }

  TriangleMesh take() { return std::move(out_); }
  std::uint64_t left_out() const { return left_out_; }
  std::uint64_t cut() const { return cut_; }

 private:
  bool is_below(std::uint32_t vertex) const { return out_.vertices[vertex].z < above_; }

  void add(const Corners& t) {
    const auto below = std::ranges::count_if(t, [&](std::uint32_t i) { return is_below(i); });
    if (below == 0) return out_.triangles.push_back(t);
    if (below == 3) {
      ++left_out_;
      return;
    }
    ++cut_;
    // Rotated so that the corner that is alone on its side comes first.
    std::size_t first = 0;
    while (is_below(t[first]) != (below == 1)) ++first;
    const std::uint32_t a = t[first], b = t[(first + 1) % 3], c = t[(first + 2) % 3];
    const std::uint32_t on_ab = place_of(a, b), on_ac = place_of(a, c);
    if (below == 2) return out_.triangles.push_back({a, on_ab, on_ac});
    out_.triangles.push_back({on_ab, b, c});
    if (b != c) out_.triangles.push_back({on_ab, c, on_ac});  // otherwise it is a segment
  }

  std::uint32_t place_of(std::uint32_t one, std::uint32_t other) {
    const auto edge = std::minmax(one, other);
    const auto [known, is_new] =
        places_.try_emplace(edge, static_cast<std::uint32_t>(out_.vertices.size()));
    if (is_new) {
      const Vec3 &a = out_.vertices[edge.first], &b = out_.vertices[edge.second];
      const double share = (above_ - a.z) / (b.z - a.z);
      out_.vertices.push_back({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), above_});
    }
    return known->second;
  }

  double above_;
  TriangleMesh out_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> places_;
  std::uint64_t left_out_ = 0, cut_ = 0;
};

void leave_out_below(const ModelInput& input, double above, TriangleMesh& mesh,
                     std::vector<Message>& messages) {
  const std::size_t all = mesh.triangles.size();
  const bool has_lines = input.remarks.segments + input.remarks.single_points > 0;
  if (!std::isfinite(above)) {
    throw UsageError(input.path.string() + ": " + format_number(above) +
                     " m as the lowest height of the model; expected a finite number");
  }
  const double bottom =
      std::ranges::min_element(mesh.vertices, {}, [](const Vec3& p) { return p.z; })->z;
  HeightCut cut(mesh, above);
  mesh = cut.take();
  if (mesh.triangles.empty()) {
    refuse(input.path.string(), "all of the model (" + contents_of(input) +
                                    ") is below z = " + format_number(above) +
                                    " m; expected some of it above that height");
  }
  messages.push_back(cut_note(input,
                              format_count(cut.left_out()) + " of " + format_count(all) +
                                  (has_lines ? " triangles, lines and points" : " triangles") +
                                  " are below z = " + format_number(above) +
                                  " m, and are left out; " + format_count(cut.cut()) +
                                  " are cut there",
                              cut.left_out(), above, bottom));
}

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

TriangleMesh kept_surface(const ModelInput& input, const ModelOptions& options,
                          std::vector<Message>& messages) {
  TriangleMesh mesh = input.mesh;
  if (const std::uint64_t unused = remove_unused(mesh); unused > 0) {
    messages.push_back(loose_vertices_warning(input, unused));
  }
  if (options.above) {
    leave_out_below(input, *options.above, mesh, messages);
    remove_unused(mesh);
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
                 {{"triangles", static_cast<double>(input.mesh.triangles.size())}}));
  if (options.radius > 0) {
    tell_bend(input, default_spacing(options.radius), "the spacing that points would have",
              messages);
  }
  return kept_surface(input, options, messages);
}

}  // namespace clearway
