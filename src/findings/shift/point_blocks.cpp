#include "findings/shift/point_blocks.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/util/tsan_annotations.hpp"

namespace clearway {
namespace {

/// Nodes of more points are not thin: finding out would take longer than it saves.
constexpr std::uint32_t kMostThin = 2048;
/// Nodes of at least so many points are divided by tasks of their own.
constexpr std::uint32_t kLeastTask = 8192;

/// Orders points along an axis; points at one place are equal.
struct Along {
  int axis;
  bool operator()(const QuantumPoint& a, const QuantumPoint& b) const {
    for (int k = 0; k < 3; ++k) {
      const int at = (axis + k) % 3;
      if (a.q[at] != b.q[at]) return a.q[at] < b.q[at];
    }
    return false;
  }
};

/// The direction in which points with these sums of products of differences from their mean vary
/// least, by Jacobi's method.
Vec3 direction_of_least(double (&m)[3][3]) {
  double turn[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int sweep = 0; sweep < 6; ++sweep) {
    for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
      if (std::abs(m[p][q]) <= 1e-15 * (std::abs(m[p][p]) + std::abs(m[q][q]))) continue;
      const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
      const double t = std::copysign(1 / (std::abs(theta) + std::sqrt(theta * theta + 1)), theta);
      const double c = 1 / std::sqrt(t * t + 1), s = t * c;
      for (int k = 0; k < 3; ++k) {
        const double a = m[k][p], b = m[k][q];
        m[k][p] = c * a - s * b;
        m[k][q] = s * a + c * b;
      }
      for (int k = 0; k < 3; ++k) {
        const double a = m[p][k], b = m[q][k];
        m[p][k] = c * a - s * b;
        m[q][k] = s * a + c * b;
      }
      for (auto& row : turn) {
        const double a = row[p], b = row[q];
        row[p] = c * a - s * b;
        row[q] = s * a + c * b;
      }
    }
  }
  int least = 0;
  for (int k = 1; k < 3; ++k) {
    if (m[k][k] < m[least][least]) least = k;
  }
  return {turn[0][least], turn[1][least], turn[2][least]};
}

}  // namespace

PointBlocks::PointBlocks(const Quantisation& quantisation, std::span<QuantumPoint> points)
    : quantisation_(quantisation), points_(points) {
  std::size_t blocks = 1;
  while (blocks * kBlock < points.size()) blocks *= 2;
  nodes_.resize(2 * blocks - 1);
  first_block_ = static_cast<std::uint32_t>(blocks - 1);
  build(0, 0, static_cast<std::uint32_t>(points.size()));
}

void PointBlocks::build(std::uint32_t index, std::uint32_t begin, std::uint32_t end) {
  Node& node = nodes_[index];
  node.begin = begin;
  node.end = end;
  const std::span<QuantumPoint> points = points_.subspan(begin, end - begin);
  std::ranges::copy(points[0].q, node.box.lo);
  std::ranges::copy(points[0].q, node.box.hi);
  for (const QuantumPoint& p : points) node.box.extend(p.q);
  int longest = 0;
  double most = -1;
  for (int k = 0; k < 3; ++k) {
    const double side = quantisation_.scale[k] * (double(node.box.hi[k]) - node.box.lo[k]);
    if (side > most) {
      most = side;
      longest = k;
    }
  }
  if (is_block(index)) {
    std::ranges::sort(points, Along{0});
    return find_thin(node);
  }
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(points.begin(), points.begin() + (middle - begin), points.end(), Along{longest});
  if (end - begin < kLeastTask) {
    build(2 * index + 1, begin, middle);
    build(2 * index + 2, middle, end);
    return find_thin(node);
  }
  const ParallelScope scope;
  const auto left = piece_of(scope, [&] { build(2 * index + 1, begin, middle); });
  const auto right = piece_of(scope, [&] { build(2 * index + 2, middle, end); });
  scope.begin();
  tbb::parallel_invoke(left, right);
  find_thin(node);
}

/// Called once the points are in their final order, because sums of doubles depend on it.
void PointBlocks::find_thin(Node& node) const {
  std::ranges::fill(node.thin, 0.0F);
  node.thin_from = 1;
  node.thin_to = 0;
  if (node.end - node.begin > kMostThin) return;
  const Vec3 corner = position(quantisation_, node.box.lo[0], node.box.lo[1], node.box.lo[2]);
  const auto from_corner = [&](std::uint32_t i) { return difference(place(i), corner); };
  Vec3 sum{};
  double products[3][3] = {};
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    const Vec3 p = from_corner(i);
    sum = sum + p;
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) products[k][j] += p[k] * p[j];
    }
  }
  const double count = node.end - node.begin;
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) products[k][j] -= sum[k] * sum[j] / count;
  }
  const Vec3 least = direction_of_least(products);
  for (int k = 0; k < 3; ++k) node.thin[k] = static_cast<float>(least[k]);
  const Vec3 thin{node.thin[0], node.thin[1], node.thin[2]};
  node.thin_from = std::numeric_limits<double>::infinity();
  node.thin_to = -node.thin_from;
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    const double along = dot(thin, from_corner(i));
    node.thin_from = std::min(node.thin_from, along);
    node.thin_to = std::max(node.thin_to, along);
  }
}

}  // namespace clearway
