#pragma once

#include <cstdint>

#include "clearway/pose.hpp"
#include "core/geometry/box.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/grid/model_groups.hpp"
#include "core/page/page.hpp"

/// What the bodies of the grid engine see, on the host and on a device: views, not owners.
namespace clearway {

/// Most poses of a run, the unit in which poses are searched.
inline constexpr std::uint32_t kRunPoses = 16;

/// Parts that one task looks at.
inline constexpr std::uint32_t kTaskParts = 128;

/// |R (m - c)| <= stretch |m - c|; `spread` bounds the rounding of both transforms, metres.
struct PoseBound {
  double stretch;
  double spread;
};

/// A node of the motion tree. Nodes of at most kRunPoses poses are searched whole, others as the
/// runs first_run .. first_run + runs - 1.
struct GridNode {
  std::uint32_t first, count, mid;
  std::uint32_t first_run;
  std::uint32_t runs;
  double spread;  ///< of mid, and the motion to any pose of the range, metres
};

/// The query, the same for all pages.
struct GridSceneView {
  const Vec3* points;  ///< model points in the order of ModelGroups
  const GridSphere* groups;
  const GridSphere* parts;
  const Pose* poses;
  const PoseBound* bounds;    ///< a pose
  const GridNode* nodes;      ///< of the motion tree
  const std::uint32_t* runs;  ///< nodes, in the order of their poses
  Quantisation quantisation;
  std::uint32_t point_count, group_count, part_count;
  std::uint32_t slots;         ///< a cell, a multiple of kBlockPoints
  std::uint32_t bucket_count;  ///< a cell, a power of two, a multiple of 64
  std::uint32_t word_count;    ///< of an occupancy, a power of two
  double radius;
  double search_radius;  ///< what is farther is no hit; exceeds the radius where floats decide
  bool float_alone;
};

/// A cell of a page: what its grid and its filters need. Lengths in metres from `origin`, the lower
/// corner of the box. Bounds: docs/design/numerics.md, "Grid".
struct GridCell {
  Box box;
  Vec3 origin;
  double group_radius;  ///< groups within this of a point find its bit in the group occupancy
  float extent[3];
  float reach;                               ///< no coordinate of a hit differs by more
  float group_reach;                         ///< likewise of a group's centre
  float outer_squared;                       ///< what is above is no hit
  float inner_squared;                       ///< what is below is one
  float per_bucket, per_bit, per_group_bit;  ///< grid steps a metre
  std::uint32_t count;
  std::uint32_t first_entry;  ///< of the page's entry_runs
  std::uint32_t node_count;
  bool exact_only;  ///< floats cannot hold these lengths: every pair goes to the predicate
};

/// A point in grid order, metres from the cell's origin.
struct alignas(16) GridPoint {
  float x, y, z;
  std::uint32_t index;  ///< in the cell
};

struct BucketRange {
  std::uint32_t begin, end;  ///< of the page's points
};

/// How often the steps of a search were taken.
struct GridStatistics {
  std::uint64_t sphere_tests = 0;
  std::uint64_t points_moved = 0;  ///< model points transformed
  std::uint64_t searches = 0;      ///< of them those that the occupancy left
  std::uint64_t bucket_tests = 0;  ///< grid cells looked up
  std::uint64_t point_tests = 0;   ///< pairs tested in float
  std::uint64_t exact_tests = 0;   ///< pairs put to the predicate

  CLEARWAY_HD void add(const GridStatistics& other) {
    sphere_tests += other.sphere_tests;
    points_moved += other.points_moved;
    searches += other.searches;
    bucket_tests += other.bucket_tests;
    point_tests += other.point_tests;
    exact_tests += other.exact_tests;
  }
};

/// A page and the memory to search it.
struct GridPageView {
  PageRef page;
  const GridCell* cells;
  const std::uint64_t* cell_runs;   ///< runs of the cells before; one more than there are cells
  const std::uint32_t* entry_runs;  ///< a node of a cell: runs of the nodes before it in the cell
  GridPoint* points;                ///< in grid order, cell by cell
  BucketRange* buckets;             ///< bucket_count a cell, zero at first
  std::uint64_t* occupancy;         ///< word_count a cell, zero at first
  std::uint64_t* group_occupancy;   ///< likewise
  std::uint64_t* done;         ///< a bit a point in grid order: hit already; null with first poses
  std::uint32_t* latest;       ///< a bucket: no point's first pose is above; null without them
  std::uint64_t* hits;         ///< blocks_per_cell a cell, zero at first
  std::uint32_t* first_poses;  ///< slots a cell, kNever at first; null where not asked for
};

}  // namespace clearway
