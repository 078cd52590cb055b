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
  /// Step of the fine lattice, metres; 0: chosen from the radius. Doubled until the field fits
  /// `most_bytes`
  double voxel = 0;
  double fineness = 1;         ///< divisor of the voxel that is chosen: 2 makes it half as large
  bool cheaply_finer = false;  ///< whether to take a smaller voxel if it costs next to nothing
  double reach = 0;  ///< metres up to which bounds are good and near points known; 0: the radius
  std::uint64_t most_bytes = std::uint64_t{64} << 20;
  /// Whether bricks are made when they are first asked for; on the host only
  bool by_need = false;
  /// Solids of the surface, or null; they must outlive the field
  const SolidParts* solids = nullptr;

  friend bool operator==(const ModelFieldOptions&, const ModelFieldOptions&) = default;
};

/// Bounds on d_M, the distance from any position in the model's frame to the nearest point of the
/// model or of its surface.
/// Lattice nodes hold exact squared distances, rounded down to float. There is a coarse lattice
/// around the whole model, and bricks of a fine one (kBrick times finer), which also hold the
/// nearest element, wherever a distance within the band can occur. Empty space takes no memory
/// beyond the coarse lattice. With a reach, coarse nodes hold their nearest element too, so that
/// every position has one near it.
/// Bounds between nodes: docs/design/numerics.md, "Model field". Source of the idea: the inverted
/// trajectory with a distance field of the tool (Sullivan et al. 2012).
class ModelField {
 public:
  /// Makes the field. Its lattice nodes are exact, by nearest-neighbour search in `tree`, which
  /// must outlive the field. radius: the band around the model in which the descent ends, metres.
  /// Uses OpenMP with `threads`.
  ModelField(const ModelTree& tree, double radius, const ModelFieldOptions& options, int threads);
  ModelField(const TriangleTree& tree, double radius, const ModelFieldOptions& options,
             int threads);

  using Bounds = ModelFieldRef::Bounds;
  static constexpr std::uint32_t kNone = ModelFieldRef::kNone;

  /// The field for look-ups. Valid while the field lives and is not moved.
  ModelFieldRef ref() const;
  /// The field for look-ups that make no bricks: where there is none yet, bounds are coarse.
  ModelFieldRef ref_as_made() const;
  Bounds bounds(const Vec3& x) const { return ref().bounds(x); }

  double voxel() const { return voxel_; }
  /// Greatest distance that the lattice extends beyond the model, metres.
  double margin() const { return margin_; }
  /// Rounding of the question whether a position is inside a solid, in metres of the model's frame;
  /// 0 without solids.
  double inside_rounding() const { return inside_ ? inside_->rounding() : 0; }
  /// Number of bricks, including those not yet made.
  std::uint64_t bricks() const { return bricks_; }
  /// Number of bricks that have been made. Must not be called during a search.
  std::uint64_t made_bricks() const;
  /// Memory of the whole field in bytes, which counts all bricks, made or not.
  std::uint64_t allocated_bytes() const;

  /// The number of the brick of a coarse cell; it is made now if it was not before. Thread safe.
  std::uint32_t made_brick(std::size_t cell) const;

 private:
  static constexpr std::uint32_t kBrick = ModelFieldRef::kBrick;
  static constexpr std::uint32_t kBrickNodes = ModelFieldRef::kBrickNodes;
  static constexpr std::uint64_t kBrickBytes =
      kBrickNodes * (sizeof(float) + sizeof(std::uint32_t));
  static constexpr std::uint32_t kNoBrick = ModelFieldRef::kNoBrick;
  // States of a brick that is not made yet; they share its word in brick_of_ with its number.
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
  double voxel_ = 0;   // step of the fine lattice, metres
  double coarse_ = 0;  // step of the coarse lattice: kBrick * voxel_
  double margin_ = 0;
  Vec3 origin_{};                      // first node of the coarse lattice
  std::uint32_t size_[3]{};            // number of coarse nodes along each axis
  std::vector<float> coarse_squared_;  // squared distances of coarse nodes [z][y][x]
  // Nearest elements of coarse nodes [z][y][x]; empty without a reach
  std::vector<std::uint32_t> coarse_nearest_;
  mutable std::vector<std::uint32_t> brick_of_;  // brick of each coarse cell, [z][y][x]
  std::uint32_t bricks_ = 0;
  std::unique_ptr<float[]> distances_;        // squared distances of bricks, each [z][y][x]
  std::unique_ptr<std::uint32_t[]> nearest_;  // nearest elements of bricks, each [z][y][x]
  mutable std::optional<FieldInside> inside_;
};

}  // namespace clearway
