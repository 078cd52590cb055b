#include "cpu/section_search.hpp"

#include <bit>
#include <cmath>

#include "core/util/macros.hpp"

namespace clearway {

/// Up to a block of points, axis by axis.
struct SectionSearch::Points {
  std::uint32_t count = 0;
  alignas(64) double at[3][kBlockPoints];
};

namespace {

/// What is known of the points of a list at the poses of a node.
struct Covered {
  alignas(64) std::int32_t column_from[kBlockPoints], column_to[kBlockPoints];
  alignas(64) std::int32_t row_from[kBlockPoints], row_to[kBlockPoints];
  /// PlaceBounds::first_in_range, or -1 where no pose can see the point in the range and the
  /// window.
  alignas(64) std::int32_t first_in_range[kBlockPoints];
};

constexpr double kMostFirst = 2147483647;  ///< that fits Covered::first_in_range

/// The cells of an axis under a range of places, counted from the first cell of the window. Ends
/// that are NaN become those of the window.
struct AxisCells {
  const SectionLattice& lattice;
  double first, last;

  AxisCells(const SectionLattice& of, double from, double to)
      : lattice(of), first(from), last(to - from - 1) {}

  /// Returns whether the range misses the window; from and to are then cells of it all the same.
  CLEARWAY_IN_CLONE bool cover(double place_from, double place_to, std::int32_t& from,
                               std::int32_t& to) const {
    double a = lattice.number_at_bound(place_from) - first;
    double b = lattice.number_at_bound(place_to) - first;
    const bool misses = (a > last) | (b < 0);
    a = a > 0 ? a : 0;
    a = a < last ? a : last;
    b = b < last ? b : last;  // for NaN, too
    b = b > 0 ? b : 0;
    from = static_cast<std::int32_t>(a);
    to = static_cast<std::int32_t>(b);
    return misses;
  }
};

/// The bounds of SectionPoseNode::bounds() of each point of a list.
CLEARWAY_SIMD_CLONES
void cover_points(const SectionPoseNode& node, const SectionLattice& lattice, double slack,
                  const double (*at)[kBlockPoints], std::uint32_t count, Covered& out) {
  double from[3][kBlockPoints], to[3][kBlockPoints], first[kBlockPoints];
  for (int a = 0; a < 3; ++a) {
    const double* const row = node.row[a];
    const double* const spread = node.spread[a];
    const double shift_from = node.shift_from[a] - slack, shift_to = node.shift_to[a] + slack;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double x = at[0][i] - node.position[0], y = at[1][i] - node.position[1],
                   z = at[2][i] - node.position[2];
      const double middle = row[0] * x + row[1] * y + row[2] * z;
      const double reach =
          spread[0] * std::fabs(x) + spread[1] * std::fabs(y) + spread[2] * std::fabs(z);
      from[a][i] = middle - reach + shift_from;
      to[a][i] = middle + reach + shift_to;
      if (a == 0) {
        first[i] = node.first_in_range(middle, reach + slack, lattice.x_from, lattice.x_to);
      }
    }
  }
  const AxisCells across(lattice, lattice.j_from, lattice.j_to);
  const AxisCells up(lattice, lattice.k_from, lattice.k_to);
  const double count_of_poses = node.count;
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool misses =
        (to[0][i] < lattice.x_from) | (from[0][i] > lattice.x_to) | (first[i] >= count_of_poses);
    const double at_least = first[i] < kMostFirst ? first[i] : kMostFirst;
    const bool is_beside = across.cover(from[1][i], to[1][i], out.column_from[i], out.column_to[i]);
    const bool is_over = up.cover(from[2][i], to[2][i], out.row_from[i], out.row_to[i]);
    out.first_in_range[i] =
        static_cast<std::int32_t>((misses | is_beside | is_over) ? -1.0 : at_least);
  }
}

/// The cells of the places of points, counted from the window's first: SectionLattice::find() of
/// each. A point that blocks nothing gets the column -1.
CLEARWAY_SIMD_CLONES
void place_points(const PullBack& pose, const SectionLattice& lattice,
                  const double (*at)[kBlockPoints], std::uint32_t count, std::int32_t* columns,
                  std::int32_t* rows) {
  double place[3][kBlockPoints];
  for (int a = 0; a < 3; ++a) {
    const Vec3 row = pose.rows[a];
    for (std::uint32_t i = 0; i < count; ++i) {
      const double x = at[0][i] - pose.position.x, y = at[1][i] - pose.position.y,
                   z = at[2][i] - pose.position.z;
      place[a][i] = (row.x * x + row.y * y + row.z * z) / pose.determinant;
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const double j = std::floor(place[1][i] / lattice.cell);
    const double k = std::floor(place[2][i] / lattice.cell);
    const bool is_in = (place[0][i] >= lattice.x_from) & (place[0][i] <= lattice.x_to) &
                       (j >= lattice.j_from) & (j < lattice.j_to) & (k >= lattice.k_from) &
                       (k < lattice.k_to);
    const double column = is_in ? j - lattice.j_from : -1.0;
    const double row = is_in ? k - lattice.k_from : 0.0;
    columns[i] = static_cast<std::int32_t>(column);
    rows[i] = static_cast<std::int32_t>(row);
  }
}

}  // namespace

void SectionSearch::search(std::uint32_t cell,
                           const std::array<PackedChunk<std::int32_t>, 3>& coordinates,
                           std::span<const std::uint64_t> searched,
                           std::span<const std::uint32_t> bins, std::uint32_t first,
                           std::uint32_t end) const {
  const Cell& of = cloud_.cells()[cell];
  const Quantisation& quantisation = cloud_.quantisation();
  const BlockBoxes boxes = cloud_.blocks(cell);
  Points points;
  for (std::uint32_t block = first; block < end; ++block) {
    const std::uint64_t all = searched.empty() ? ~std::uint64_t{0} : searched[block];
    if (all == 0) continue;
    const Box box = position_box(quantisation, decode_block_box(of.box, boxes[block]));
    points.count = 0;
    for (const std::uint32_t bin : bins) {
      if (!section_.may_block(section_.nodes[bin], box)) continue;
      if (points.count == 0) {
        std::array<std::int32_t, kBlockPoints> q{};
        const std::uint32_t count = std::min(kBlockPoints, of.count - block * kBlockPoints);
        for (int axis = 0; axis < 3; ++axis) {
          coordinates[static_cast<std::size_t>(axis)].decode(block * kBlockPoints,
                                                             std::span(q).first(count));
          points.count = 0;
          for (std::uint32_t i = 0; i < count; ++i) {
            if ((all >> i & 1) == 0) continue;
            points.at[axis][points.count++] = coordinate(quantisation, axis, q[i]);
          }
        }
      }
      visit(bin, points);
    }
  }
}

void SectionSearch::visit(std::uint32_t at, const Points& points) const {
  const SectionPoseNode& node = section_.nodes[at];
  const SectionMapRef map = section_.map(node.bin);
  Covered covered;
  cover_points(node, section_.lattice, section_.slack, points.at, points.count, covered);
  std::uint32_t kept[kBlockPoints];
  Points left;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const SectionRect rect{static_cast<std::uint32_t>(covered.column_from[i]),
                           static_cast<std::uint32_t>(covered.column_to[i]),
                           static_cast<std::uint32_t>(covered.row_from[i]),
                           static_cast<std::uint32_t>(covered.row_to[i])};
    const bool is_in_range = covered.first_in_range[i] >= 0;
    const std::uint32_t pose =
        node.first_pose + static_cast<std::uint32_t>(std::max(covered.first_in_range[i], 0));
    // Few branches, as they could hardly be foretold.
    bool is_left = is_in_range & (map.last_corner(rect) > pose);
    const bool is_small =
        (rect.column_to - rect.column_from <= 1) & (rect.row_to - rect.row_from <= 1);
    if (is_in_range & !is_left & !is_small) is_left = !map.is_blocked_inside(rect, pose);
    kept[left.count] = i;
    left.count += is_left ? 1 : 0;
  }
  if (left.count == 0) return;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::uint32_t i = 0; i < left.count; ++i) left.at[axis][i] = points.at[axis][kept[i]];
  }
  if (node.is_leaf()) return visit_poses(node, left);
  visit(at + 1, left);
  visit(node.right, left);
}

void SectionSearch::visit_poses(const SectionPoseNode& node, const Points& points) const {
  const SectionMapRef map = section_.map(node.bin);
  std::int32_t columns[kBlockPoints], rows[kBlockPoints];
  for (std::uint32_t pose = node.first; pose < node.first + node.count; ++pose) {
    place_points(section_.pull_backs[pose], section_.lattice, points.at, points.count, columns,
                 rows);
    const std::uint32_t path_pose = section_.path_pose[pose];
    for (std::uint32_t i = 0; i < points.count; ++i) {
      if (columns[i] < 0) continue;
      map.block(static_cast<std::uint32_t>(columns[i]), static_cast<std::uint32_t>(rows[i]),
                path_pose);
    }
  }
}

}  // namespace clearway
