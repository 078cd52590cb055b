#include "cpu/model_spheres.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "clearway/error.hpp"

namespace clearway {

struct ModelSpheres::Keyed {
  std::uint64_t key;  ///< Morton code of the finest grid cell
  Vec3 point;
};

namespace {

constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 28;

/// The bits of `value`, three places apart.
std::uint64_t spread_bits(std::uint64_t value) {
  std::uint64_t out = 0;
  for (int bit = 0; bit < ModelSpheres::kLevels; ++bit) out |= (value >> bit & 1) << 3 * bit;
  return out;
}

std::uint64_t grid_key(const Box& box, double edge, const Vec3& point) {
  constexpr double kSteps = std::uint64_t{1} << ModelSpheres::kLevels;
  std::uint64_t key = 0;
  for (int k = 0; k < 3; ++k) {
    const double step = (point[k] - box.lo[k]) / edge * kSteps;
    const double clamped = step > 0 ? std::min(step, kSteps - 1) : 0.0;  // 0 for NaN
    key |= spread_bits(static_cast<std::uint64_t>(clamped)) << k;
  }
  return key;
}

/// An upper bound on the true length whose computed square is `squared` (docs/design/numerics.md,
/// "Spheres of the model").
double length_above(double squared) {
  return std::sqrt(squared) * (1 + 16 * std::numeric_limits<double>::epsilon()) + 1e-150;
}

}  // namespace

ModelSpheres::ModelSpheres(std::span<const Vec3> model, double leaf_radius)
    : leaf_radius_(leaf_radius) {
  if (model.empty()) return;
  if (model.size() >= kMostPoints) {
    throw InputError("a model of " + std::to_string(model.size()) +
                     " points, expected fewer than " + std::to_string(kMostPoints));
  }
  box_ = {model[0], model[0]};
  for (const Vec3& m : model) box_.extend(m);
  const double edge = box_.size()[box_.longest_axis()];
  std::vector<Keyed> points;
  points.reserve(model.size());
  for (const Vec3& m : model) points.push_back({grid_key(box_, edge, m), m});
  std::stable_sort(points.begin(), points.end(),
                   [](const Keyed& a, const Keyed& b) { return a.key < b.key; });
  nodes_.push_back(make_sphere(points));
  add_children(0, points, kLevels);
}

void ModelSpheres::add_children(std::uint32_t parent, std::span<const Keyed> points, int level) {
  const bool small = points.size() <= kLeafPoints && nodes_[parent].radius <= leaf_radius_;
  if (points.size() == 1 || small || level == 0) {
    add_columns(nodes_[parent], points);
    return;
  }
  const auto digit = [&](const Keyed& p) { return p.key >> 3 * (level - 1) & 7; };
  std::array<std::size_t, 9> starts{};
  for (const Keyed& p : points) ++starts[digit(p) + 1];
  for (std::size_t i = 1; i < starts.size(); ++i) starts[i] += starts[i - 1];

  const auto first_child = static_cast<std::uint32_t>(nodes_.size());
  std::array<std::span<const Keyed>, 8> parts;
  std::uint32_t children = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    if (starts[i] == starts[i + 1]) continue;
    parts[children++] = points.subspan(starts[i], starts[i + 1] - starts[i]);
  }
  if (children == 1) return add_children(parent, points, level - 1);
  for (std::uint32_t i = 0; i < children; ++i) nodes_.push_back(make_sphere(parts[i]));
  nodes_[parent].first_child = first_child;
  nodes_[parent].children = children;
  for (std::uint32_t i = 0; i < children; ++i) {
    add_children(first_child + i, parts[i], level - 1);
  }
}

ModelSphere ModelSpheres::make_sphere(std::span<const Keyed> points) const {
  const auto farthest = [&](const Vec3& centre) {
    double greatest = 0;
    for (const Keyed& p : points) {
      greatest = std::max(greatest, squared_distance(p.point, centre));
    }
    return greatest;
  };
  Box box{points[0].point, points[0].point};
  for (const Keyed& p : points) box.extend(p.point);
  const Vec3 middle{box.lo.x / 2 + box.hi.x / 2, box.lo.y / 2 + box.hi.y / 2,
                    box.lo.z / 2 + box.hi.z / 2};
  const auto nearest =
      std::min_element(points.begin(), points.end(), [&](const Keyed& a, const Keyed& b) {
        return squared_distance(a.point, middle) < squared_distance(b.point, middle);
      });
  Vec3 centre = nearest->point;
  double greatest = farthest(centre);
  if (points.size() <= std::size_t{2} * kLeafPoints) {
    for (const Keyed& p : points) {
      const double candidate = farthest(p.point);
      if (candidate < greatest) {
        greatest = candidate;
        centre = p.point;
      }
    }
  }
  const auto count = static_cast<std::uint32_t>(points.size());
  return {centre, length_above(greatest), 0, 0, count, 0, 0};
}

void ModelSpheres::add_columns(ModelSphere& leaf, std::span<const Keyed> points) {
  leaf.first = static_cast<std::uint32_t>(x_.size());
  for (const Keyed& p : points) {
    x_.push_back(p.point.x);
    y_.push_back(p.point.y);
    z_.push_back(p.point.z);
  }
  while ((x_.size() - leaf.first) % kColumnStep != 0) {
    x_.push_back(x_.back());
    y_.push_back(y_.back());
    z_.push_back(z_.back());
  }
  leaf.padded = static_cast<std::uint32_t>(x_.size()) - leaf.first;
  largest_leaf_ = std::max(largest_leaf_, leaf.padded);
}

}  // namespace clearway
