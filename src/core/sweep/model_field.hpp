#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/model_tree.hpp"
#include "core/sweep/model_field_ref.hpp"

namespace clearway {

struct ModelFieldOptions {
  double voxel = 0;     ///< metres; 0: chosen from the radius. Doubled until it fits `most_bytes`
  double fineness = 1;  ///< of the voxel that is chosen: 2 makes it half as large
  bool cheaply_finer = false;  ///< a smaller voxel where it costs next to nothing
  double reach = 0;  ///< metres: good bounds and near points out to here; 0: to the radius only
  std::uint64_t most_bytes = std::uint64_t{64} << 20;
};

/// Bounds of d_M, the distance from any position in the model's frame to the nearest model point.
/// Lattice nodes hold exact squared distances, rounded down to float: a coarse lattice around the
/// whole model, and bricks of a fine one (kBrick times finer), with the nearest point too, wherever
/// a distance within the band can occur. No memory for empty space but the coarse lattice. With a
/// reach, coarse nodes keep their nearest point too, and every position has one near it. Between
/// nodes: docs/design/numerics.md, "Model field". Source of the idea: the inverted trajectory with
/// a distance field of the tool (Sullivan et al. 2012).
class ModelField {
 public:
  /// Exact for lattice nodes by nearest-neighbour search in `tree`, which must outlive the field.
  /// radius: the band around the model in which the descent ends. Uses OpenMP with `threads`.
  ModelField(const ModelTree& tree, double radius, const ModelFieldOptions& options, int threads);

  using Bounds = ModelFieldRef::Bounds;
  static constexpr std::uint32_t kNone = ModelFieldRef::kNone;

  /// Valid while the field lives.
  ModelFieldRef ref() const;
  Bounds bounds(const Vec3& x) const { return ref().bounds(x); }

  double voxel() const { return voxel_; }
  /// How far the lattice goes beyond the model at the most, metres.
  double margin() const { return margin_; }
  std::uint64_t bricks() const { return distances_.size() / kBrickNodes; }
  std::uint64_t allocated_bytes() const;

 private:
  static constexpr std::uint32_t kBrick = ModelFieldRef::kBrick;
  static constexpr std::uint32_t kBrickNodes = ModelFieldRef::kBrickNodes;
  static constexpr std::uint32_t kNoBrick = ModelFieldRef::kNoBrick;

  void choose_voxel(double radius, const ModelFieldOptions& options);
  double band(double radius, double reach) const;
  double margin_steps(double reach) const;
  void lay_out(double margin);
  void fill_coarse(bool with_nearest, int threads);
  std::uint64_t mark_bricks(double band, int threads);
  void fill_bricks(int threads);
  Vec3 coarse_node(std::uint32_t ix, std::uint32_t iy, std::uint32_t iz) const;

  const ModelTree& tree_;
  double voxel_ = 0;   // fine
  double coarse_ = 0;  // kBrick * voxel_
  double margin_ = 0;
  Vec3 origin_{};                              // of the coarse lattice
  std::uint32_t size_[3]{};                    // coarse nodes along each axis
  std::vector<float> coarse_squared_;          // [z][y][x]
  std::vector<std::uint32_t> coarse_nearest_;  // likewise, with a reach
  std::vector<std::uint32_t> brick_of_;        // per coarse cell, [z][y][x]
  std::vector<float> distances_;               // squared, per brick [z][y][x]
  std::vector<std::uint32_t> nearest_;         // likewise
};

}  // namespace clearway
