#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "core/geometry/model_tree.hpp"
#include "core/sweep/field/brick_part.hpp"
#include "core/sweep/field/model_field_ref.hpp"

namespace clearway {

/// Finds the nearest model points of all nodes of a brick together. Model points that are not the
/// nearest of any position within a part of the brick are left out for all of its nodes at once.
/// Allocates some 100 kB.
class BrickNearest {
 public:
  /// tree: not empty; it must outlive this object.
  explicit BrickNearest(const ModelTree& tree) : tree_(tree) {}

  /// Finds for each node [z][y][x] the squared distance, rounded down to float, and a nearest point
  /// (ModelFieldRef::kBrickNodes of both). corner: the brick's first node; voxel: metres from a
  /// node to the next.
  void find(const Vec3& corner, double voxel, float* squared, std::uint32_t* nearest);

 private:
  using Part = BrickPart;
  using Place = BrickPlace;

  struct Candidate {
    Vec3 point;
    std::uint32_t index;
  };

  static constexpr std::uint32_t kMostGathered = 1024;
  static constexpr std::uint32_t kLevels = 3;  ///< levels of parts: 9, 5 and 3 nodes along an axis

  void find_in(const Part& part, std::span<const Candidate> candidates, std::uint32_t level);
  bool gather(const Place& place, std::span<const Candidate>& out);
  std::span<const Candidate> narrowed(const Place& place, std::span<const Candidate> candidates,
                                      std::uint32_t level);
  void find_among(const Part& part, std::span<const Candidate> candidates);
  void find_in_tree(const Part& part);

  const ModelTree& tree_;
  BrickLattice lattice_{};
  BrickNodes nodes_;
  std::uint32_t near_ = 0;  ///< a point near the last place, from which searches begin
  using Gathered = std::array<Candidate, kMostGathered>;
  /// The candidates of the part at work on each level; on the heap, as stacks may be small.
  std::unique_ptr<Gathered[]> kept_ = std::make_unique_for_overwrite<Gathered[]>(kLevels);
};

}  // namespace clearway
