#include "findings/colliding_spacing.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "io/files/parallel_loop.hpp"

namespace clearway {
namespace {

/// Distances between places in the unit of the scale.
class Distances {
 public:
  explicit Distances(const Quantisation& quantisation) {
    for (std::size_t k = 0; k < 3; ++k) step_[k] = std::abs(quantisation.scale[k]);
  }

  double step(int axis) const { return step_[static_cast<std::size_t>(axis)]; }
  double along(const QuantumPoint& a, const QuantumPoint& b, int axis) const {
    return static_cast<double>(difference_of(a.q[axis], b.q[axis])) * step(axis);
  }
  /// The squared distance of two points; infinity where they are at one place.
  double squared(const QuantumPoint& a, const QuantumPoint& b) const {
    if (same_place(a, b)) return std::numeric_limits<double>::infinity();
    const double x = along(a, b, 0), y = along(a, b, 1), z = along(a, b, 2);
    return x * x + y * y + z * z;
  }
  /// No point of a box is nearer than the root of this.
  double squared(const QuantumPoint& a, const QuantumBox& box) const {
    QuantumPoint nearest{};
    for (int k = 0; k < 3; ++k) nearest.q[k] = std::clamp(a.q[k], box.lo[k], box.hi[k]);
    return same_place(a, nearest) ? 0 : squared(a, nearest);
  }

  static bool same_place(const QuantumPoint& a, const QuantumPoint& b) {
    return a.q[0] == b.q[0] && a.q[1] == b.q[1] && a.q[2] == b.q[2];
  }
  static bool is_before(const QuantumPoint& a, const QuantumPoint& b) {
    return std::ranges::lexicographical_compare(a.q, b.q);
  }

 private:
  std::array<double, 3> step_{};
};

/// Each place of some points once.
std::vector<QuantumPoint> places_of(std::span<const QuantumPoint> points) {
  std::vector<QuantumPoint> out(points.begin(), points.end());
  tbb::parallel_sort(out, Distances::is_before);
  out.erase(std::unique(out.begin(), out.end(), Distances::same_place), out.end());
  return out;
}

/// Lowers `least` to the squared distance from a point to the nearest one of a node that is at
/// another place.
void keep_nearest_other(const PointBlocks& tree, std::uint32_t node, const QuantumPoint& point,
                        const Distances& distances, double& least) {
  if (tree.is_block(node)) {
    for (const QuantumPoint& other : tree.points(node)) {
      least = std::min(least, distances.squared(other, point));
    }
    return;
  }
  std::array<std::pair<double, std::uint32_t>, 2> halves{
      {{distances.squared(point, tree.node(2 * node + 1).box), 2 * node + 1},
       {distances.squared(point, tree.node(2 * node + 2).box), 2 * node + 2}}};
  if (halves[1] < halves[0]) std::swap(halves[0], halves[1]);
  for (const auto& [away, half] : halves) {
    if (away < least) keep_nearest_other(tree, half, point, distances, least);
  }
}

/// The squared distance from a point to the nearest one of a tree that is at another place;
/// infinity where there is none.
double nearest_other(const PointBlocks& tree, const QuantumPoint& point,
                     const Distances& distances) {
  double least = std::numeric_limits<double>::infinity();
  keep_nearest_other(tree, 0, point, distances, least);
  return least;
}

/// The distances from places to the nearest point at another place, found in one pass over all
/// points. Each place has a ball about it, and each point is compared with the places whose balls
/// reach into its cube. Where one size of cubes leaves too many places in a cube, each ball has
/// cubes of its own size.
class NearestToPlaces {
 public:
  /// places: no two the same; they must outlive this object. squared_radii: of their balls, each
  /// at most the squared distance to some point at another place.
  NearestToPlaces(std::span<const QuantumPoint> places, std::span<const double> squared_radii,
                  const Distances& distances)
      : places_(places), distances_(distances), squared_(places.size()) {
    for (std::size_t i = 0; i < places.size(); ++i) squared_[i] = squared_radii[i];
    const double largest = *std::ranges::max_element(squared_radii);
    fill_buckets([largest](double) { return largest; });
    if (comparisons() > kMostComparisons) fill_buckets([](double own) { return own; });
  }

  /// Compares a point with the places that it may be nearest to. Thread safe.
  void compare(const QuantumPoint& point) {
    for (const Size& size : sizes_) {
      const std::uint32_t bucket = bucket_at(point, size);
      for (std::uint32_t at = first_[bucket]; at < first_[bucket + 1]; ++at) {
        const std::uint32_t place = place_of_entry_[at];
        keep_least(distances_.squared(places_[place], point), squared_[place]);
      }
    }
  }

  /// The squared distance to the nearest point that compare() was called for, where one lies within
  /// the ball of the place; otherwise the squared radius.
  double squared(std::size_t place) const { return squared_[place]; }

 private:
  struct Entry {
    std::uint32_t bucket, place;
  };
  /// The size of cubes: their edges are 2 to the power of the exponent, in metres.
  struct Size {
    int exponent;
    double per_metre;
  };
  /// With more comparisons of a point, cubes of several sizes are faster.
  static constexpr double kMostComparisons = 100;
  static constexpr int kBucketBits = 20;
  static constexpr std::size_t kBuckets = std::size_t{1} << kBucketBits;

  static std::int64_t cube_at(double metres, const Size& size) {
    const double cubes = metres * size.per_metre;
    const auto whole = static_cast<std::int64_t>(cubes);
    return whole - (cubes < static_cast<double>(whole) ? 1 : 0);
  }
  std::int64_t cube_at(const QuantumPoint& point, int axis, const Size& size) const {
    return cube_at(point.q[axis] * distances_.step(axis), size);
  }

  /// Different cubes may share a bucket, which costs time alone.
  static std::uint32_t bucket_of(int exponent, const std::array<std::int64_t, 3>& cube) {
    auto hash = static_cast<std::uint64_t>(exponent);
    for (const std::int64_t c : cube) {
      hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15;
      hash ^= hash >> 32;
    }
    return static_cast<std::uint32_t>(hash & (kBuckets - 1));
  }

  /// size_of(squared radius): the squared radius by which the cubes are as large as they are.
  template <typename SizeOf>
  void fill_buckets(const SizeOf& size_of) {
    sizes_.clear();
    std::vector<Entry> entries;
    for (std::uint32_t i = 0; i < places_.size(); ++i) {
      add_ball(i, std::sqrt(squared_[i]), std::sqrt(size_of(squared_[i])), entries);
    }
    first_.assign(kBuckets + 2, 0);
    for (const Entry& entry : entries) ++first_[entry.bucket + 2];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    place_of_entry_.resize(entries.size());
    for (const Entry& entry : entries) place_of_entry_[first_[entry.bucket + 1]++] = entry.place;
  }

  /// The number of places that a point is compared with, as seen at the places themselves.
  double comparisons() const {
    double sum = 0;
    for (const QuantumPoint& place : places_) {
      for (const Size& size : sizes_) {
        const std::uint32_t bucket = bucket_at(place, size);
        sum += first_[bucket + 1] - first_[bucket];
      }
    }
    return sum / static_cast<double>(places_.size());
  }

  std::uint32_t bucket_at(const QuantumPoint& point, const Size& size) const {
    return bucket_of(size.exponent,
                     {cube_at(point, 0, size), cube_at(point, 1, size), cube_at(point, 2, size)});
  }

  void add_ball(std::uint32_t place, double radius, double size_radius,
                std::vector<Entry>& entries) {
    // Cubes of one to two radii, of which a ball reaches at most three along each axis.
    const int exponent = std::ilogb(size_radius) + 1;
    const Size size{exponent, std::ldexp(1.0, -exponent)};
    if (std::ranges::find(sizes_, exponent, &Size::exponent) == sizes_.end()) {
      sizes_.push_back(size);
    }
    std::array<std::int64_t, 3> lo, hi;
    for (int k = 0; k < 3; ++k) {
      const double at = places_[place].q[k] * distances_.step(k);
      const double reach = radius * (1 + kRounding) + kRounding * distances_.step(k);
      lo[static_cast<std::size_t>(k)] = cube_at(at - reach, size);
      hi[static_cast<std::size_t>(k)] = cube_at(at + reach, size);
    }
    for (std::int64_t x = lo[0]; x <= hi[0]; ++x) {
      for (std::int64_t y = lo[1]; y <= hi[1]; ++y) {
        for (std::int64_t z = lo[2]; z <= hi[2]; ++z) {
          entries.push_back({bucket_of(exponent, {x, y, z}), place});
        }
      }
    }
  }

  static void keep_least(double value, std::atomic<double>& least) {
    double known = least.load(std::memory_order_relaxed);
    while (value < known && !least.compare_exchange_weak(known, value)) continue;
  }

  /// Coordinates are rounded by less than this share of a radius and of a step.
  static constexpr double kRounding = 1e-6;

  std::span<const QuantumPoint> places_;
  const Distances distances_;
  std::vector<std::atomic<double>> squared_;
  std::vector<Size> sizes_;
  std::vector<std::uint32_t> first_, place_of_entry_;
};

/// The lower median; `values` are put into another order.
double median_of(std::vector<double>& values) {
  const auto median = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), median, values.end());
  return *median;
}

/// One of so many points is compared first.
constexpr std::size_t kPartOfPoints = 8;
/// A tree of all points is faster up to so many times the sample.
constexpr std::size_t kFewTimes = 2;

/// Calls visit(i) for each i below `count`, by many threads. Throws Interrupted.
template <typename Visit>
void for_each_of(std::size_t count, Progress& progress, const Visit& visit) {
  using Range = tbb::blocked_range<std::size_t>;
  for_each_parallel(Range(0, count, 1024), [&](const Range& range) {
    if (progress.stop_requested()) return;
    for (std::size_t i = range.begin(); i < range.end(); ++i) visit(i);
  });
  throw_if_stopped(progress);
}

/// The median for a sample of many points, which has these places. The distances of its own points
/// to each other bound those to all points, and none above their median needs to be known.
double spacing_of_many(std::span<const QuantumPoint> points, std::span<const QuantumPoint> sample,
                       const std::vector<QuantumPoint>& places, const Quantisation& quantisation,
                       Progress& progress) {
  const Distances distances(quantisation);
  std::vector<QuantumPoint> in_tree = places;
  const PointBlocks tree(quantisation, in_tree);
  std::vector<double> squared(places.size());
  for_each_of(places.size(), progress,
              [&](std::size_t i) { squared[i] = nearest_other(tree, places[i], distances); });
  std::vector<std::uint32_t> place_of(sample.size());
  std::vector<double> of_sample(sample.size());
  for_each_of(sample.size(), progress, [&](std::size_t i) {
    const auto at = std::ranges::lower_bound(places, sample[i], Distances::is_before);
    place_of[i] = static_cast<std::uint32_t>(at - places.begin());
    of_sample[i] = squared[place_of[i]];
  });
  // A part of the points makes the balls smaller for all of them.
  for (const std::size_t step : {kPartOfPoints, std::size_t{1}}) {
    const double most = median_of(of_sample);
    for (double& value : squared) value = std::min(value, most);
    NearestToPlaces nearest(places, squared, distances);
    for_each_of((points.size() + step - 1) / step, progress,
                [&](std::size_t i) { nearest.compare(points[i * step]); });
    for (std::size_t i = 0; i < places.size(); ++i) squared[i] = nearest.squared(i);
    for (std::size_t i = 0; i < sample.size(); ++i) of_sample[i] = squared[place_of[i]];
  }
  return std::sqrt(median_of(of_sample));
}

}  // namespace

std::optional<double> colliding_spacing(std::span<const QuantumPoint> points,
                                        const Quantisation& quantisation, Progress& progress) {
  const std::size_t every = (points.size() + kSpacingSample - 1) / kSpacingSample;
  if (every > kFewTimes) {
    std::vector<QuantumPoint> sample;
    for (std::size_t i = 0; i < points.size(); i += every) sample.push_back(points[i]);
    const std::vector<QuantumPoint> places = places_of(sample);
    if (places.size() >= kLeastPlaces) {
      return spacing_of_many(points, sample, places, quantisation, progress);
    }
  }
  std::vector<QuantumPoint> places = places_of(points);
  if (places.size() < kLeastPlaces) return std::nullopt;
  const PointBlocks tree(quantisation, places);
  const Distances distances(quantisation);
  std::vector<double> squared((points.size() + every - 1) / every);
  for_each_of(squared.size(), progress, [&](std::size_t i) {
    squared[i] = nearest_other(tree, points[i * every], distances);
  });
  return std::sqrt(median_of(squared));
}

Grouping usual_grouping(bool any, std::optional<double> spacing, double metre) {
  constexpr double kUsualGap = 0.3, kPatch = 0.01;  // metres, square metres
  constexpr double kMostPoints = 10, kWhole = 1e-9;
  if (!any) return {kUsualGap / metre, static_cast<std::uint64_t>(kMostPoints)};
  if (!spacing) return {kUsualGap / metre, 1};
  const double s = *spacing * metre, points = kPatch / (s * s), whole = std::round(points);
  // What is a whole number but for roundings is taken for it.
  const double least = std::abs(points - whole) <= kWhole * points ? whole : std::ceil(points);
  return {std::max(kUsualGap / metre, 3 * *spacing),
          static_cast<std::uint64_t>(std::clamp(least, 1.0, kMostPoints))};
}

}  // namespace clearway
