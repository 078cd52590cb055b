#include "io/model/surface_cover.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace clearway {
namespace {

// Shares of the spacing, which the proof adds up.
constexpr double kMargin = 0x1p-16;  // reserve for all rounding
constexpr double kFlat = 0x1p-17;    // a triangle of less height is treated as its longest side
// Distance by which the sides are moved outwards before clipping.
constexpr double kClipMargin = 0x1p-18;
constexpr int kSplits = 5;  // splits of a region to find whether several samples cover it

/// The sides of a triangle, moved outwards by `margin`.
std::array<HalfPlane, 3> sides_of(const TriangleFrame& t, double margin) {
  const auto side = [margin](const FlatPlace& a, const FlatPlace& b) {
    const double x = b.x - a.x, y = b.y - a.y, length = std::hypot(x, y);
    const double along = -y / length, up = x / length;
    return HalfPlane{along, up, margin - (along * a.x + up * a.y)};
  };
  const FlatPlace a{0, 0}, b{t.length, 0}, c{t.foot, t.height};
  return {side(a, b), side(b, c), side(c, a)};
}

}  // namespace

/// A lattice of rows of nodes parallel to the longest side, where every other row is shifted by
/// half a step. Each place of the triangle is within `reach` of its nearest node.
struct SurfaceCover::Lattice {
  double rows, row_step;  ///< number of rows, and the distance from one to the next
  double steps, step;     ///< number of steps in a row, and the length of one
  double first_row;       ///< height of the first row above the longest side
  double radius;          ///< radius of the circle about a node's region, at most the reach
  FlatPolygon region;     ///< region of a node at (0, 0): the places nearest to it

  Lattice(const TriangleFrame& t, double reach) {
    rows = std::max(1.0, std::ceil((t.height + 2 * reach) / (1.5 * reach)) - 1);
    row_step = (t.height + 2 * reach) / (rows + 1);
    const double widest = 2 * std::sqrt(row_step * (2 * reach - row_step));
    steps = std::max(1.0, std::ceil(t.length / widest));
    step = t.length / steps;
    first_row = row_step - reach;
    radius = (step * step / 4 + row_step * row_step) / (2 * row_step);
    const double half = step / 2, side = row_step - radius;
    region = {{0, -radius}, {half, -side}, {half, side},
              {0, radius},  {-half, side}, {-half, -side}};
    if (t.height == 0) region = {{-half, 0}, {half, 0}};
  }
};

SurfaceCover::SurfaceCover(double spacing, std::uint64_t most)
    : spacing_(spacing), reach_(spacing * (1 - kMargin)), most_(most), samples_(spacing) {}

bool SurfaceCover::corners_cover(const TriangleFrame& triangle) const {
  if (triangle.length <= reach_) return true;
  return triangle.height > 0 && triangle.corner_distance() <= reach_;
}

double SurfaceCover::estimate(const Vec3& a, const Vec3& b, const Vec3& c) const {
  TriangleFrame triangle(a, b, c);
  if (triangle.height <= kFlat * spacing_) triangle.flatten();
  if (corners_cover(triangle)) return 0;
  const Lattice lattice(triangle, reach_);
  return lattice.rows * (lattice.steps / 2 + 1) + lattice.steps;
}

bool SurfaceCover::cover(const Vec3& a, const Vec3& b, const Vec3& c) {
  TriangleFrame t(a, b, c);
  if (t.height <= kFlat * spacing_) t.flatten();
  if (corners_cover(t)) return true;
  const Lattice lattice(t, reach_);
  const auto sides = sides_of(t, kClipMargin * spacing_);
  for (double row = 0; row < lattice.rows; ++row) {
    const double y = lattice.first_row + row * lattice.row_step;
    const double shift = std::fmod(row, 2) * lattice.step / 2;
    const double low = t.height > 0 ? std::clamp((y - lattice.radius) / t.height, 0.0, 1.0) : 0;
    const double left = t.foot * low, right = t.length - (t.length - t.foot) * low;
    const double first = std::floor((left - shift) / lattice.step - 0.5) - 1;
    const double last = std::ceil((right - shift) / lattice.step + 0.5) + 1;
    for (double k = first; k <= last; ++k) {
      const FlatPlace node{shift + k * lattice.step, y};
      FlatPolygon region = lattice.region.moved_by(node);
      if (t.height > 0) {
        for (const HalfPlane& side : sides) region = region.clipped(side);
      } else {
        region = region.clipped({1, 0, 0}).clipped({-1, 0, t.length});
      }
      if (!region.empty() && !cover_node(t, region, node)) return false;
    }
  }
  return true;
}

bool SurfaceCover::cover_node(const TriangleFrame& triangle, const FlatPolygon& region,
                              const FlatPlace& node) {
  if (covered(triangle, region, kSplits)) return true;
  if (samples_.size() >= most_) return false;
  samples_.add(triangle.nearest_in_space(node));
  return true;
}

/// Whether samples cover a region: a single one covers all of it, or each of its parts is covered.
bool SurfaceCover::covered(const TriangleFrame& triangle, const FlatPolygon& region,
                           int splits) const {
  std::array<Vec3, FlatPolygon::kMostCorners> corners;
  FlatPlace middle{0, 0};
  std::size_t count = 0;
  for (const FlatPlace& corner : region) {
    corners[count++] = triangle.in_space(corner);
    middle.x += corner.x;
    middle.y += corner.y;
  }
  const auto share = static_cast<double>(count);
  const Vec3 inside = triangle.in_space({middle.x / share, middle.y / share});
  const double limit = reach_ * reach_;
  bool any = false;
  const bool one = samples_.any_near(inside, [&](const Vec3& sample) {
    if (squared_distance(sample, inside) > limit) return false;
    any = true;
    return std::all_of(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(count),
                       [&](const Vec3& p) { return squared_distance(sample, p) <= limit; });
  });
  if (one || !any || splits == 0) return one;
  const auto [first, second] = region.halves();
  return (first.empty() || covered(triangle, first, splits - 1)) &&
         (second.empty() || covered(triangle, second, splits - 1));
}

}  // namespace clearway
