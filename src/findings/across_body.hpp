#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/query.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/util/progress.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/point_groups.hpp"
#include "findings/touched_first.hpp"

namespace clearway {

/// Where points lie across a body, seen along its path: to the left and up in its frame.
struct AcrossBody {
  double left_from = kMost, left_to = -kMost;  ///< y0 and y1, metres to the left
  double up_from = kMost, up_to = -kMost;      ///< z0 and z1, metres up
  /// Whether any of the points lies in the middle half of the body's width and height.
  bool in_middle = false;

  bool is_empty() const { return left_from > left_to; }
  void add(const AcrossBody& other);
  friend bool operator==(const AcrossBody&, const AcrossBody&) = default;

 private:
  static constexpr double kMost = std::numeric_limits<double>::infinity();
};

/// A conflict, or a part of a group: by which body and on which poses it is touched, and where its
/// points lie then.
struct PartAcross {
  std::uint32_t body = 0;  ///< the one that is touched first
  /// The poses of its range; between poses, those of all of its ways.
  std::uint32_t first_pose = 0, last_pose = 0;
  AcrossBody found = {};
};

/// What moves, and how it is seen. All references must outlive it.
struct BodiesAcross {
  std::span<const MovingBody> bodies;
  std::span<const Box> boxes;  ///< of each body's model, in its own frame
  AheadLeftUp axes;
  double radius;
  bool ways;  ///< whether bodies are followed from pose to pose

  /// The box of a body along the axes of ahead_left_up().
  Box whole_box(std::uint32_t body) const;
  /// The box of a body from its floor up, along the axes of ahead_left_up().
  Box box_from_floor(std::uint32_t body) const;
};

/// Finds for each part where its points lie across its body, at all poses of its range at which
/// they are closer than the radius to the body's box and at its floor or above; between poses, at
/// both ends of each way that may come so near, and as far beyond as the body's turn may take them.
/// part_of_row: the index of each row's part + 1, 0 for rows of no part. Runs in the caller's arena
/// of oneTBB. Throws Interrupted.
void find_across_bodies(const CellGrid& grid, const PointGroups& groups,
                        std::span<const std::uint32_t> part_of_row,
                        const Quantisation& quantisation, const BodiesAcross& how,
                        std::vector<PartAcross>& parts, Progress& progress);

/// Sets the trims and the side of a conflict, whose first_touch is known. body: the body's box from
/// its floor up, and whole: its box, both along the axes of ahead_left_up().
void set_trims(const AcrossBody& found, const Box& body, const Box& whole, double radius,
               Conflict& conflict);

}  // namespace clearway
