#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "core/geometry/model_tree.hpp"
#include "core/sweep/field/field_inside.hpp"
#include "core/sweep/field/model_field_ref.hpp"

namespace clearway {

struct ModelFieldOptions {
  double voxel = 0;     ///< metres; 0: chosen from the radius. Doubled until it fits `most_bytes`
  double fineness = 1;  ///< of the voxel that is chosen: 2 makes it half as large
  bool cheaply_finer = false;  ///< a smaller voxel where it costs next to nothing
  double reach = 0;  ///< metres: good bounds and near points out to here; 0: to the radius only
  std::uint64_t most_bytes = std::uint64_t{64} << 20;
  bool by_need = false;  ///< bricks are made when they are first asked for; on the host only
  const SolidParts* solids = nullptr;  ///< of the surface, if any; outlives the field
};

/// Bounds of d_M, the distance from any position in the model's frame to the nearest point of the
/// model or of its surface.
/// Lattice nodes hold exact squared distances, rounded down to float: a coarse lattice around the
/// whole model, and bricks of a fine one (kBrick times finer), with the nearest element too,
/// wherever a distance within the band can occur. No memory for empty space but the coarse lattice.
/// With a reach, coarse nodes keep their nearest element too, and every position has one near it.
/// Between nodes: docs/design/numerics.md, "Model field". Source of the idea: the inverted
/// trajectory with a distance field of the tool (Sullivan et al. 2012).
class ModelField {
 public:
  /// Exact for lattice nodes by nearest-neighbour search in `tree`, which must outlive the field.
  /// radius: the band around the model in which the descent ends. Uses OpenMP with `threads`.
  ModelField(const ModelTree& tree, double radius, const ModelFieldOptions& options, int threads);
  ModelField(const TriangleTree& tree, double radius, const ModelFieldOptions& options,
             int threads);

  using Bounds = ModelFieldRef::Bounds;
  static constexpr std::uint32_t kNone = ModelFieldRef::kNone;

  /// Valid while the field lives and stays where it is.
  ModelFieldRef ref() const;
  /// The same, but no look-up makes a brick: where there is none yet, bounds are coarse.
  ModelFieldRef ref_as_made() const;
  Bounds bounds(const Vec3& x) const { return ref().bounds(x); }

  double voxel() const { return voxel_; }
  /// How far the lattice goes beyond the model at the most, metres.
  double margin() const { return margin_; }
  /// Of the question what is inside, metres of the model's frame; 0 without solids.
  double inside_rounding() const { return inside_ ? inside_->rounding() : 0; }
  /// Those not yet made included.
  std::uint64_t bricks() const { return bricks_; }
  /// Of all bricks, made or not.
  std::uint64_t allocated_bytes() const;

  /// The number of the brick of that coarse cell, which is made now unless it was. Thread safe.
  std::uint32_t made_brick(std::size_t cell) const;

 private:
  static constexpr std::uint32_t kBrick = ModelFieldRef::kBrick;
  static constexpr std::uint32_t kBrickNodes = ModelFieldRef::kBrickNodes;
  static constexpr std::uint64_t kBrickBytes =
      kBrickNodes * (sizeof(float) + sizeof(std::uint32_t));
  static constexpr std::uint32_t kNoBrick = ModelFieldRef::kNoBrick;
  // Of a brick in brick_of_ that is not there yet, beside its number.
  static constexpr std::uint32_t kToBeMade = ModelFieldRef::kToBeMade;
  static constexpr std::uint32_t kBeingMade = kToBeMade >> 1;
  static constexpr std::uint32_t kBrickNumber = kBeingMade - 1;

  using Tree = std::variant<const ModelTree*, const TriangleTree*>;

  ModelField(Tree tree, const Box& model, double spacing, double radius,
             const ModelFieldOptions& options, int threads);

  bool is_surface() const { return std::holds_alternative<const TriangleTree*>(tree_); }
  void choose_voxel(double spacing, double radius, const ModelFieldOptions& options);
  double band(double radius, double reach) const;
  double margin_steps(double reach) const;
  void lay_out(double margin);
  void fill_coarse(bool with_nearest, int threads);
  template <typename Element>
  void fill_coarse_from(const ModelTreeOf<Element>& tree, bool with_nearest, int threads);
  std::uint32_t mark_bricks(double band, int threads);
  template <typename Element>
  void mark_bricks_from(const ModelTreeOf<Element>& tree, double band, int threads);
  double node_error() const;
  std::uint64_t brick_bytes() const;
  void make_all(int threads);
  void make_brick(std::size_t cell) const;
  Vec3 coarse_node(std::uint32_t ix, std::uint32_t iy, std::uint32_t iz) const;

  const Tree tree_;
  const Box model_;
  const bool by_need_;
  double voxel_ = 0;   // fine
  double coarse_ = 0;  // kBrick * voxel_
  double margin_ = 0;
  Vec3 origin_{};                                // of the coarse lattice
  std::uint32_t size_[3]{};                      // coarse nodes along each axis
  std::vector<float> coarse_squared_;            // [z][y][x]
  std::vector<std::uint32_t> coarse_nearest_;    // likewise, with a reach
  mutable std::vector<std::uint32_t> brick_of_;  // per coarse cell, [z][y][x]
  std::uint32_t bricks_ = 0;
  std::unique_ptr<float[]> distances_;        // squared, per brick [z][y][x]
  std::unique_ptr<std::uint32_t[]> nearest_;  // likewise
  mutable std::optional<FieldInside> inside_;
};

}  // namespace clearway
