#include "core/geometry/solid_parts.hpp"

#include <algorithm>

#include "core/geometry/model_tree.hpp"
#include "core/geometry/triangle_box.hpp"

namespace clearway {
namespace {

/// The triangles of each solid.
std::vector<std::vector<Triangle>> by_solid(const Model& model) {
  std::vector<std::vector<Triangle>> solids;
  for (std::size_t i = 0; i < model.solid_of.size(); ++i) {
    const std::uint32_t solid = model.solid_of[i];
    if (solid == kNoSolid) continue;
    if (solid >= solids.size()) solids.resize(solid + std::size_t{1});
    const auto& [a, b, c] = model.triangles[i];
    solids[solid].push_back({model.vertices[a], model.vertices[b], model.vertices[c]});
  }
  std::erase_if(solids, [](const auto& solid) { return solid.empty(); });
  return solids;
}

}  // namespace

SolidParts::SolidParts(const Model& model, int threads) {
  for (const std::vector<Triangle>& solid : by_solid(model)) add(solid, threads);
  if (!triangles_.empty()) lattice_ = SolidLattice(box_of(std::span<const Triangle>(triangles_)));
}

void SolidParts::add(const std::vector<Triangle>& solid, int threads) {
  const ModelTreeOf<Triangle> tree(solid, threads);
  const ModelTreeOf<Triangle>::Ref ref = tree.ref();
  parts_.push_back({static_cast<std::uint32_t>(triangles_.size()), ref.size,
                    static_cast<std::uint32_t>(boxes_.size()), ref.box_count});
  triangles_.insert(triangles_.end(), ref.elements, ref.elements + ref.size);
  boxes_.insert(boxes_.end(), ref.boxes, ref.boxes + ref.box_count);
}

double SolidParts::rounding() const { return 2 * lattice_.step; }

}  // namespace clearway
