#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/vec3.hpp"
#include "core/geometry/box.hpp"
#include "cpu/range_kernels.hpp"

namespace clearway {

/// A bounding sphere of the model points in one cell of a regular grid over the model. The centre
/// is one of these points, so that a distance to the moved centre is itself a distance of the
/// predicate.
struct ModelSphere {
  Vec3 centre;
  double radius;              ///< no point is farther than this from the centre, rounding included
  std::uint32_t first;        ///< first place of the leaf in the columns; leaves only
  std::uint32_t padded;       ///< number of points in the columns, a multiple of 8; leaves only
  std::uint32_t count;        ///< number of model points below this node
  std::uint32_t first_child;  ///< children are consecutive
  std::uint32_t children;     ///< 0 for a leaf
};

/// The model partitioned into a regular grid of bounding spheres, with coarser grids of twice the
/// edge above it, up to one sphere around all. A grid cell is split while it holds more than
/// kLeafPoints or is wide compared with the search radius. Source: Schauer et al. (the paper),
/// section 3.1.
class ModelSpheres {
 public:
  static constexpr std::uint32_t kLeafPoints = 16;
  static constexpr std::uint32_t kColumnStep = 8;
  static constexpr int kLevels = 21;

  /// Builds the spheres. Spheres of several points with a radius above `leaf_radius` are split as
  /// far as the finest grid goes. Throws InputError for a model of 2^28 or more points.
  ModelSpheres(std::span<const Vec3> model, double leaf_radius);

  /// Node `index`; node 0 is the root.
  const ModelSphere& node(std::uint32_t index) const { return nodes_[index]; }
  const Box& box() const { return box_; }
  /// Largest padded size of a leaf.
  std::uint32_t largest_leaf() const { return largest_leaf_; }

  std::uint64_t allocated_bytes() const {
    return nodes_.capacity() * sizeof(ModelSphere) +
           (x_.capacity() + y_.capacity() + z_.capacity()) * sizeof(double);
  }

  /// A leaf's points; the last one is repeated up to `padded`.
  Columns columns(const ModelSphere& leaf) const {
    return {x_.data() + leaf.first, y_.data() + leaf.first, z_.data() + leaf.first};
  }

 private:
  struct Keyed;
  void add_children(std::uint32_t parent, std::span<const Keyed> points, int level);
  ModelSphere make_sphere(std::span<const Keyed> points) const;
  void add_columns(ModelSphere& leaf, std::span<const Keyed> points);

  std::vector<ModelSphere> nodes_;
  std::vector<double> x_, y_, z_;
  Box box_{};
  double leaf_radius_;
  std::uint32_t largest_leaf_ = 0;
};

}  // namespace clearway
