#include "io/models/sample_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "clearway/vec3.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/geometry/point_box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/util/format.hpp"
#include "io/models/mesh/mesh_builder.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway {
namespace {

constexpr std::size_t kManyPoints = 64;

/// The least squared distance from `place` to one of the points at another place; infinite where
/// there is none.
double least_to_others(const Vec3& place, std::span<const Vec3> points) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& point : points) {
    if (point != place) least = std::min(least, squared_distance(place, point));
  }
  return least;
}

/// The distance of one of the tree's points to its nearest neighbour. guess: about this distance.
double gap_of(const ModelTree& tree, const Vec3& place, double guess, std::vector<Vec3>& near) {
  bool grown = false;
  for (double reach = guess;;) {
    const std::size_t most = grown ? tree.size() : kManyPoints;
    if (!tree.within({place, place}, reach * reach, most, near) && reach * reach > 0) {
      reach /= 2;
      continue;
    }
    const double least = least_to_others(place, near);
    if (least <= reach * reach) return std::sqrt(least);
    reach *= 2;
    grown = true;
  }
}

}  // namespace

PointGaps gaps_of(std::span<const Vec3> points) {
  std::vector<Vec3> places;
  VertexWelder welder(places);
  for (const Vec3& point : points) welder.number_of(point);
  PointGaps found{.repeated = points.size() - places.size()};
  if (places.size() < 2) return found;
  const ModelTree tree(places);
  std::vector<double> gaps;
  std::vector<Vec3> near;
  double guess = tree.spacing() > 0 ? tree.spacing() : 1;
  for (const Vec3& place : places) {
    gaps.push_back(gap_of(tree, place, guess, near));
    if (gaps.back() > 0) guess = gaps.back();
  }
  found.largest = *std::max_element(gaps.begin(), gaps.end());
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2),
                   gaps.end());
  found.median = gaps[gaps.size() / 2];
  return found;
}

namespace {

/// Points in a hash grid that finds those within a reach.
class SampleSet {
 public:
  /// reach: above 0; coordinates are at most 2^31 times as large.
  explicit SampleSet(double reach) : reach_(reach), heads_(1024, kNone) {}

  const std::vector<Vec3>& points() const { return points_; }
  std::vector<Vec3> take_points() { return std::move(points_); }
  std::size_t size() const { return points_.size(); }

  void add(const Vec3& point);

  /// Calls use(point) until it returns true, at most kMostLooks times and the last added point
  /// first. It is called for the points within the reach of `place`, except for some at the reach
  /// up to rounding, and for some farther ones. Returns whether `use` returned true.
  template <typename Use>
  bool any_near(const Vec3& place, Use use) const {
    const Cell middle = cell_of(place);
    std::uint32_t looks = 0;
    for (std::int64_t x = middle.x - 1; x <= middle.x + 1; ++x) {
      for (std::int64_t y = middle.y - 1; y <= middle.y + 1; ++y) {
        for (std::int64_t z = middle.z - 1; z <= middle.z + 1; ++z) {
          for (std::uint32_t i = heads_[slot_of({x, y, z})]; i != kNone; i = next_[i]) {
            if (use(points_[i])) return true;
            if (++looks == kMostLooks) return false;
          }
        }
      }
    }
    return false;
  }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  /// Most calls of `use` in any_near(). Without a limit, all vertices of a fine part that a coarse
  /// triangle passes would be examined for each of the triangle's places.
  static constexpr std::uint32_t kMostLooks = 1024;

  struct Cell {
    std::int64_t x, y, z;
  };

  Cell cell_of(const Vec3& point) const;
  /// The slot of a cell; cells that share a slot share their points.
  std::size_t slot_of(const Cell& cell) const {
    std::uint64_t hash = static_cast<std::uint64_t>(cell.x) * 0x9E3779B97F4A7C15;
    hash = (hash ^ (hash >> 32) ^ static_cast<std::uint64_t>(cell.y)) * 0xD6E8FEB86659FD93;
    hash = (hash ^ (hash >> 32) ^ static_cast<std::uint64_t>(cell.z)) * 0xD6E8FEB86659FD93;
    return (hash ^ (hash >> 32)) & (heads_.size() - 1);
  }
  void grow();

  double reach_;
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> next_;  // next point of the same slot
  // First point of each slot; the number of slots is a power of two.
  std::vector<std::uint32_t> heads_;
};

SampleSet::Cell SampleSet::cell_of(const Vec3& point) const {
  return {static_cast<std::int64_t>(std::floor(point.x / reach_)),
          static_cast<std::int64_t>(std::floor(point.y / reach_)),
          static_cast<std::int64_t>(std::floor(point.z / reach_))};
}

void SampleSet::add(const Vec3& point) {
  if (points_.size() == heads_.size()) grow();
  std::uint32_t& head = heads_[slot_of(cell_of(point))];
  next_.push_back(head);
  head = static_cast<std::uint32_t>(points_.size());
  points_.push_back(point);
}

void SampleSet::grow() {
  heads_.assign(2 * heads_.size(), kNone);
  for (std::uint32_t i = 0; i < points_.size(); ++i) {
    std::uint32_t& head = heads_[slot_of(cell_of(points_[i]))];
    next_[i] = head;
    head = i;
  }
}

/// Samples that cover triangles: no place of a triangle given to cover() is farther than `spacing`
/// from a sample.
///
/// A triangle of the height H is laid flat with its longest side on the x axis. R is a little less
/// than the spacing h. If each place is within R of a corner, nothing is added. Otherwise a lattice
/// of nodes is laid over it, in m rows parallel to the longest side, every other one shifted by
/// w / 2. Rows are d apart and nodes in a row w apart. Each node has a region, which is the places
/// of the triangle that are nearest to it. A region that samples cover already is left out; for any
/// other one the sample is the place of the triangle nearest to the node.
///
/// The lattice covers. d = (H + 2 R) / (m + 1) with the least m for which d <= 1.5 R, so
/// R <= d <= 1.5 R, and w = 2 sqrt(d (2 R - d)) or less. Three neighbouring nodes form an isosceles
/// triangle with base w and height d. Its circumradius is (w^2 / 4 + d^2) / (2 d) <= R, and it is
/// acute because d >= R, so each place between the rows is within R of a node. The lowest row lies
/// at d - R, and the places below it are within sqrt((d - R)^2 + w^2 / 4) <= R of a node of that
/// row. The same holds above the highest row, because (m - 1) d + 2 (d - R) = H.
///
/// A sample serves as its node does. A triangle is convex, so no place of it is farther from the
/// sample than from the node. A region is left out only with proof: balls and regions are convex,
/// so if all corners of a region are within R of one sample, all its places are. Otherwise it is
/// cut in two, at most kSplits times, and each part needs a sample of its own.
///
/// Rounding. Let u = 2^-53 and M the largest coordinate. Sampling is refused unless M <= 2^28 h, so
/// u M <= 2^-25 h. The lengths of the flat triangle differ from those in space by at most 60 u M, a
/// flat place put into space by 17 u M, the corners of a region after three sides and five cuts by
/// 40 u M, and a node's place by 10 u M: together 127 u M < 2^-18 h. R is h (1 - kMargin). A
/// triangle with H <= kFlat h is taken for its longest side, which moves its places by at most
/// kFlat h. The triangle's sides are moved out by kClipMargin h before they cut a region, which is
/// more than their own rounding, so a region never loses a place. Hence a place is at most
/// h (1 - 2^-16 + 2^-17 + 2^-18) < h from a sample.
///
/// A sample is A + s (B - A) + t (C - A) with s, t >= 0 and s + t <= 1, up to 2 u. Each coordinate
/// is off by at most 10 u M, and so the sample by 18 u M < 2^-48 M.
class SurfaceCover {
 public:
  /// most: number of samples that may be added before cover() gives up.
  SurfaceCover(double spacing, std::uint64_t most);

  void add(const Vec3& sample) { samples_.add(sample); }
  /// Adds the samples that cover a triangle, whose corners are samples already. Returns false where
  /// `most` samples do not suffice.
  bool cover(const Vec3& a, const Vec3& b, const Vec3& c);
  /// Estimated number of samples for a triangle: about the number of nodes of its lattice; 0 where
  /// its corners suffice.
  double estimate(const Vec3& a, const Vec3& b, const Vec3& c) const;

  SampleSet& samples() { return samples_; }

 private:
  struct Lattice;

  bool corners_cover(const TriangleFrame& triangle) const;
  bool cover_node(const TriangleFrame& triangle, const FlatPolygon& region, const FlatPlace& node);
  bool covered(const TriangleFrame& triangle, const FlatPolygon& region, int splits) const;

  double spacing_, reach_;
  std::uint64_t most_;
  SampleSet samples_;
};

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

// Greatest coordinate in spacings, which the proof requires.
constexpr double kMostSpacings = 0x1p28;

/// The positions of the vertices that triangles use, each once, in the order of the vertices.
std::vector<Vec3> used_vertices(const TriangleMesh& mesh) {
  std::vector<bool> used(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) used[corner] = true;
  }
  std::vector<Vec3> places;
  VertexWelder welder(places);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) welder.number_of(mesh.vertices[i]);
  }
  return places;
}

double estimate(const TriangleMesh& mesh, double spacing) {
  const SurfaceCover cover(spacing, 0);
  double samples = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    samples += cover.estimate(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
  }
  return samples;
}

/// The next greater round number of the series 1, 2, 5, 10 ...
double rounder(double spacing) {
  const double power = std::pow(10, std::floor(std::log10(spacing)));
  for (const double digit : {1, 2, 5}) {
    if (digit * power > spacing * 1.0001) return digit * power;
  }
  return 10 * power;
}

[[noreturn]] void refuse_spacing(const TriangleMesh& mesh, double spacing, double samples,
                                 const std::vector<Vec3>& vertices, const std::string& name) {
  double fits = spacing;
  do {
    fits = rounder(fits);
  } while (fits < kLargestSpacing && estimate(mesh, fits) > kMostSamples / 2.0);
  const Box box = box_of(vertices);
  refuse(name,
         fmt::format("the mesh is {} x {} x {} m; at a spacing of {} m it takes {}, and at most {} "
                     "are allowed. Is the file in metres? A spacing of {} m is possible",
                     format_brief(box.hi.x - box.lo.x), format_brief(box.hi.y - box.lo.y),
                     format_brief(box.hi.z - box.lo.z), format_number(spacing),
                     samples > 0 ? "some " + format_brief(samples) + " points" : "more points",
                     format_count(kMostSamples), format_number(fits)),
         Remedy::kModelSpacing, fits);
}

void check_spacing(const std::vector<Vec3>& vertices, double spacing, const std::string& name) {
  if (!(spacing >= kLeastSpacing && spacing <= kLargestSpacing)) {
    throw UsageError(name + ": a model spacing of " + format_number(spacing) +
                     " m; expected one from 1e-9 to 1e9");
  }
  double largest = 0;
  for (const Vec3& v : vertices) {
    largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  }
  if (largest > spacing * kMostSpacings) {
    refuse(name,
           "coordinates up to " + format_brief(largest) + " m are too large for a spacing of " +
               format_number(spacing) + " m; expected at most " +
               format_brief(spacing * kMostSpacings) + " m. Move the model to its own origin",
           Remedy::kModelSpacing);
  }
}

}  // namespace

std::vector<Vec3> sample_mesh(const TriangleMesh& mesh, double spacing, const std::string& name) {
  const std::vector<Vec3> vertices = used_vertices(mesh);
  check_spacing(vertices, spacing, name);
  const double expected = estimate(mesh, spacing);
  if (expected > kMostSamples) refuse_spacing(mesh, spacing, expected, vertices, name);
  SurfaceCover cover(spacing, kMostSamples);
  for (const Vec3& vertex : vertices) cover.add(vertex);
  for (const auto& [a, b, c] : mesh.triangles) {
    if (!cover.cover(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c])) {
      refuse_spacing(mesh, spacing, expected, vertices, name);
    }
  }
  return cover.samples().take_points();
}

double distance_to_vertices(const TriangleMesh& mesh) {
  double farthest = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const TriangleFrame frame(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    farthest = std::max(farthest, frame.height > 0 ? frame.corner_distance() : frame.length / 2);
  }
  return farthest;
}

double spacing_for(const TriangleMesh& mesh, double samples) {
  double area = 0, reach = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
    const Vec3 ab = difference(b, a), ac = difference(c, a);
    const Vec3 normal{ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z,
                      ab.x * ac.y - ab.y * ac.x};
    area += std::sqrt(squared_length(normal.x, normal.y, normal.z)) / 2;
    for (int axis = 0; axis < 3; ++axis) {
      reach = std::max({reach, std::abs(a[axis]), std::abs(b[axis]), std::abs(c[axis])});
    }
  }
  // A lattice of equilateral triangles whose places are within h of a node has 2 / (3 sqrt(3) h^2)
  // nodes per area (Kershner 1939).
  const double of_area = std::sqrt(2 * area / (3 * std::sqrt(3.0) * samples));
  double spacing =
      std::clamp(std::max(of_area, reach * 0x1p-27), 2 * kLeastSpacing, kLargestSpacing / 2);
  // Lines have no area. Triangles about as large as the spacing need up to fifteen times as many
  // samples as their area suggests, which does no harm.
  constexpr double kMuchMore = 32;
  while (spacing < kLargestSpacing / 2 && estimate(mesh, spacing) > kMuchMore * samples) {
    spacing = std::min(2 * spacing, kLargestSpacing / 2);
  }
  return spacing;
}

}  // namespace clearway
