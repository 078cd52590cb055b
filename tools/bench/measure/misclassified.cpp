#include "bench/measure/misclassified.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/result/result.hpp"

namespace clearway::bench {
namespace {

constexpr double kDecades[] = {1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8,
                               1e-7,  1e-6,  1e-5,  1e-4,  1e-3,  1e-2,  1e-1,  1e0};
static_assert(std::size(kDecades) + 1 == std::tuple_size_v<decltype(Misclassified::histogram)>);

std::size_t decade_of(double distance) {
  return static_cast<std::size_t>(
      std::upper_bound(std::begin(kDecades), std::end(kDecades), distance) - std::begin(kDecades));
}

void check_reach(const ResultReader& truth, double radius) {
  const double clearance = truth.header().clearance;
  if (clearance > radius) return;
  refuse(truth.name(), "clearances up to " + format_number(clearance) +
                           " m; expected them beyond " + format_number(radius) +
                           " m (--clearance)");
}

/// Looks up distances by ascending source index.
class Distances {
 public:
  explicit Distances(const ResultReader& truth) : rows_(truth) {}

  /// The distance of a point; nullopt where the point has no clearance below D.
  std::optional<double> of(std::uint64_t source) {
    while (!rows_.at_end() && rows_.source() < source) rows_.advance();
    if (rows_.at_end() || rows_.source() != source) return std::nullopt;
    return rows_.get(&Clearances::distance);
  }

  /// Reads the rows that are left, because their hash is checked at the end.
  void read_rest() {
    while (!rows_.at_end()) rows_.advance();
  }

 private:
  ClearanceCursor rows_;
};

}  // namespace

Misclassified misclassified(const ResultReader& truth, const ResultReader& other) {
  const double radius = truth.header().radius;
  check_reach(truth, radius);
  Misclassified out;
  out.environment_points = truth.header().environment_points;
  if (other.header().environment_points < out.environment_points) {
    refuse(other.name(), std::to_string(other.header().environment_points) +
                             " environment points; expected at least the " +
                             std::to_string(out.environment_points) + " of " + truth.name());
  }
  CollisionCursor right(truth), found(other);
  Distances distances(truth);
  const auto note = [&](double d) {
    const double distance = std::abs(d - radius);
    out.largest_distance = std::max(out.largest_distance, distance);
    ++out.histogram[decade_of(distance)];
  };
  const auto miss = [&] {
    ++out.misses;
    const auto d = distances.of(right.source());
    if (!d) {
      refuse(truth.name(), "point " + std::to_string(right.source()) +
                               " collides, but has no clearance; the file is damaged");
    }
    note(*d);
  };
  const auto false_hit = [&] {
    if (found.source() >= out.environment_points) return;
    ++out.false_hits;
    const auto d = distances.of(found.source());
    if (d) {
      note(*d);
    } else {
      ++out.beyond;
    }
  };
  merge_rows(right, found, miss, false_hit, [] {});
  distances.read_rest();
  return out;
}

NearBoundary points_near_boundary(const ResultReader& truth, double radius) {
  NearBoundary out{};
  const double ulp = std::nextafter(radius, std::numeric_limits<double>::infinity()) - radius;
  const auto ulps = [ulp](std::size_t i) { return std::ldexp(ulp, static_cast<int>(i)); };
  check_reach(truth, radius + ulps(out.size() - 1));
  for (ClearanceCursor rows(truth); !rows.at_end(); rows.advance()) {
    const double distance =
        std::abs(rows.get(&Clearances::distance) - radius);  // exact near the radius (Sterbenz)
    for (std::size_t i = out.size(); i > 0 && distance <= ulps(i - 1); --i) ++out[i - 1];
  }
  return out;
}

}  // namespace clearway::bench
