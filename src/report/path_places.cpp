#include "report/path_places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/box.hpp"
#include "core/geometry/predicate.hpp"

namespace clearway {
namespace {

constexpr double kLeastMargin = 10, kMostMargin = 40;  // metres beside the model
constexpr double kDiagonalsInMargin = 3;
constexpr double kDenseMargin = 2;
constexpr std::size_t kMostPlaces = 5'000;

constexpr double kRounding = 1e-9;  // share of a squared distance

double length(const Vec3& a, const Vec3& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }

double top_at(const Box& model, const Pose& pose) {
  double top = -std::numeric_limits<double>::infinity();
  for (unsigned k = 0; k < 8; ++k) top = std::max(top, transform(pose, model.corner(k)).z);
  return top;
}

double path_length(std::span<const Vec3> centres) {
  double sum = 0;
  for (std::size_t i = 1; i < centres.size(); ++i) sum += length(centres[i - 1], centres[i]);
  return sum;
}

}  // namespace

PathPlaces::PathPlaces(std::span<const DrawnBody> bodies) {
  for (const DrawnBody& body : bodies) {
    half_diagonal_ = std::max(half_diagonal_, length(body.box.lo, body.box.hi) / 2);
  }
  reach_ = half_diagonal_ +
           std::clamp(2 * kDiagonalsInMargin * half_diagonal_, kLeastMargin, kMostMargin);
  dense_reach_ = half_diagonal_ + kDenseMargin;
  for (const DrawnBody& body : bodies) add(body);
}

void PathPlaces::add(const DrawnBody& body) {
  std::vector<Vec3> centres;
  centres.reserve(body.poses.size());
  for (const Pose& pose : body.poses) centres.push_back(transform(pose, body.box.centre()));
  const double step =
      std::max(reach_ / 12, path_length(centres) / static_cast<double>(kMostPlaces));
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (i == 0 || i + 1 == centres.size() || length(places_.back().centre, centres[i]) >= step) {
      places_.push_back({centres[i], top_at(body.box, body.poses[i])});
    }
  }
}

void PathPlaces::near(const Box& box, std::vector<std::uint32_t>& out) const {
  out.clear();
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    if (least_squared_distance(box, places_[i].centre) <= reach_ * reach_) out.push_back(i);
  }
}

void PathPlaces::keep_nearest(const Box& box, std::vector<std::uint32_t>& places) const {
  // Every place of the box is as near to one of the places as this.
  double near = std::numeric_limits<double>::infinity();
  for (const std::uint32_t i : places) {
    near = std::min(near, greatest_squared_distance(box, places_[i].centre));
  }
  near *= 1 + kRounding;
  std::erase_if(places, [&](std::uint32_t i) {
    return least_squared_distance(box, places_[i].centre) > near;
  });
}

double PathPlaces::distance(const Box& box, std::span<const std::uint32_t> among) const {
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t i : among) {
    least = std::min(least, least_squared_distance(box, places_[i].centre));
  }
  return std::sqrt(least);
}

const PathPlaces::Place& PathPlaces::nearest(const Vec3& point,
                                             std::span<const std::uint32_t> among) const {
  return places_[*std::ranges::min_element(
      among, {}, [&](std::uint32_t i) { return length(places_[i].centre, point); })];
}

}  // namespace clearway
