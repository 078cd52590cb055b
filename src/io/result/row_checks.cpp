#include "io/result/row_checks.hpp"

#include <cmath>

#include "clearway/result.hpp"
#include "io/result/result_names.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

namespace names = result_names;

bool is_finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

bool is_absent(const Vec3& p) { return std::isnan(p.x) && std::isnan(p.y) && std::isnan(p.z); }

}  // namespace

void RowChecks::refuse_row(const char* dataset, std::size_t row,
                           const std::string& expected) const {
  throw InputError(name + ": /" + group + "/" + dataset + ", row " + std::to_string(first + row) +
                   ": expected " + expected);
}

void RowChecks::sources(std::span<const std::uint64_t> source) const {
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (source[i] >= header.environment_points || (i > 0 && source[i] <= source[i - 1])) {
      refuse_row(names::kSource, i, "an index above the row before and below environment_points");
    }
  }
}

void RowChecks::points(std::span<const Vec3> xyz) const {
  for (std::size_t i = 0; i < xyz.size(); ++i) {
    if (!is_finite(xyz[i])) refuse_row(names::kXyz, i, "finite coordinates");
  }
}

void RowChecks::poses(const char* dataset, std::span<const std::uint32_t> pose) const {
  for (std::size_t i = 0; i < pose.size(); ++i) {
    if (pose[i] >= header.poses) refuse_row(dataset, i, "a pose below poses");
  }
}

void RowChecks::bodies(std::span<const std::uint32_t> body) const {
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (body[i] >= header.bodies.size()) refuse_row(names::kBody, i, "one of the bodies");
  }
}

bool RowChecks::is_distance(double distance) const {
  return distance >= 0 || (header.model_solids > 0 && distance < 0 && std::isfinite(distance));
}

void RowChecks::clearances(std::span<const double> distance) const {
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (!(is_distance(distance[i]) && distance[i] <= header.clearance)) {
      refuse_row(names::kDistance, i, "a distance from 0 to the clearance");
    }
  }
}

void RowChecks::profile(std::span<const double> distance, std::span<const std::uint64_t> source,
                        std::span<const Vec3> xyz) const {
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (source[i] == Profile::kNoPoint) {
      if (!(std::isinf(distance[i]) && distance[i] > 0)) {
        refuse_row(names::kDistance, i, "infinity, as the pose has no point");
      }
      if (!is_absent(xyz[i])) {
        refuse_row(names::kXyz, i, "no numbers (NaN), as the pose has no point");
      }
      continue;
    }
    if (source[i] >= header.environment_points) {
      refuse_row(names::kSource, i, "an index below environment_points, or 2^64 - 1 for none");
    }
    // The root of a number below fl(D D) may round to D, so D itself is valid.
    if (!(is_distance(distance[i]) && distance[i] <= header.profile)) {
      refuse_row(names::kDistance, i, "a distance from 0 to the profile's");
    }
    if (!is_finite(xyz[i])) refuse_row(names::kXyz, i, "finite coordinates");
  }
}

void RowChecks::chainages(std::span<const double> chainage) const {
  for (std::size_t i = 0; i < chainage.size(); ++i) {
    if (first == 0 && i == 0 && chainage[i] != 0) refuse_row(names::kChainage, i, "0");
    if (!(chainage[i] >= (i > 0 ? chainage[i - 1] : 0))) {
      refuse_row(names::kChainage, i, "metres, not below the row before");
    }
  }
}

}  // namespace clearway
