#pragma once

#include <cstdint>

#include "clearway/pose.hpp"
#include "core/geometry/box.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/geometry/rigid.hpp"
#include "core/grid/model_groups.hpp"
#include "core/page/page.hpp"

/// The data that the functions of the grid engine see, on the host and on a device: views, not
/// owners.
namespace clearway {

/// Greatest number of poses of a run, the unit in which poses are searched.
inline constexpr std::uint32_t kRunPoses = 16;

/// Number of parts that one task handles.
inline constexpr std::uint32_t kTaskParts = 128;

/// A node of the motion tree. A node of at most kRunPoses poses is searched as a whole, a larger
/// one as the runs first_run .. first_run + runs - 1.
struct GridNode {
  std::uint32_t first, count, mid;
  std::uint32_t first_run;
  std::uint32_t runs;
  double spread;  ///< spread of mid plus the motion from mid to any pose of the range, metres
};

/// The data of the query, which is the same for all pages.
struct GridSceneView {
  const Vec3* points;  ///< model points in the order of ModelGroups
  const GridSphere* groups;
  const GridSphere* parts;
  const Pose* poses;
  const PoseBound* bounds;    ///< one for each pose
  const GridNode* nodes;      ///< one for each node of the motion tree
  const std::uint32_t* runs;  ///< nodes, in the order of their poses
  Quantisation quantisation;
  std::uint32_t point_count, group_count, part_count;
  std::uint32_t slots;         ///< slots of a cell, a multiple of kBlockPoints
  std::uint32_t bucket_count;  ///< buckets of a cell, a power of two and a multiple of 64
  std::uint32_t word_count;    ///< words of an occupancy, a power of two
  double radius;
  double search_radius;  ///< pairs farther apart are no hit; exceeds the radius if floats decide
  bool float_alone;
};

/// The grid and the filters of a cell of a page. Lengths are in metres, places relative to
/// `origin`, the lower corner of the box. Bounds: docs/design/numerics.md, "Grid".
struct GridCell {
  Box box;
  Vec3 origin;
  double group_radius;  ///< groups within this of a point find its bit in the group occupancy
  float extent[3];
  float reach;          ///< bound on the difference of a hit's coordinates along any axis
  float group_reach;    ///< bound on such a difference between a point and a group's centre
  float outer_squared;  ///< pairs with a greater square are no hit
  float inner_squared;  ///< pairs with a smaller square are a hit
  float per_bucket, per_bit, per_group_bit;  ///< grid steps per metre
  std::uint32_t count;
  std::uint32_t first_entry;  ///< index of its first entry in the page's entry_runs
  std::uint32_t node_count;
  /// True if floats cannot hold these lengths, so that every pair goes to the predicate
  bool exact_only;
};

/// A point in grid order, metres from the cell's origin.
struct alignas(16) GridPoint {
  float x, y, z;
  std::uint32_t index;  ///< index in the cell
};

struct BucketRange {
  std::uint32_t begin, end;  ///< range of the page's points
};

/// Counts of the steps that a search took.
struct GridStatistics {
  std::uint64_t sphere_tests = 0;
  std::uint64_t points_moved = 0;  ///< model points that were transformed
  std::uint64_t searches = 0;      ///< moved model points that the occupancy left
  std::uint64_t bucket_tests = 0;  ///< grid cells that were looked up
  std::uint64_t point_tests = 0;   ///< pairs that were tested in float
  std::uint64_t exact_tests = 0;   ///< pairs for which the predicate was evaluated

  CLEARWAY_HD void add(const GridStatistics& other) {
    sphere_tests += other.sphere_tests;
    points_moved += other.points_moved;
    searches += other.searches;
    bucket_tests += other.bucket_tests;
    point_tests += other.point_tests;
    exact_tests += other.exact_tests;
  }
};

/// A page and the memory for searching it.
struct GridPageView {
  PageRef page;
  const GridCell* cells;
  /// Number of runs in the cells before; one more than there are cells
  const std::uint64_t* cell_runs;
  /// For each node of a cell, number of runs of the nodes before it in the cell
  const std::uint32_t* entry_runs;
  GridPoint* points;               ///< in grid order, cell by cell
  BucketRange* buckets;            ///< bucket_count for each cell, initially zero
  std::uint64_t* occupancy;        ///< word_count for each cell, initially zero
  std::uint64_t* group_occupancy;  ///< word_count for each cell, initially zero
  std::uint64_t* done;             ///< one bit for each point in grid order, set once it is hit
  std::uint64_t* hits;             ///< blocks_per_cell for each cell, initially zero
};

}  // namespace clearway
