#include "core/geometry/outline.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "clearway/error.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

/// A sum of doubles that is kept exactly: numbers of which each is smaller than the last place of
/// the next.
class ExactSum {
 public:
  void add(double value) {
    for (std::size_t i = 0; i < count_; ++i) {
      const double sum = parts_[i] + value;
      const double other = sum - parts_[i];
      parts_[i] = (parts_[i] - (sum - other)) + (value - other);
      value = sum;
    }
    parts_[count_++] = value;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  int sign() const {
    for (std::size_t i = count_; i-- > 0;) {
      if (parts_[i] != 0) return parts_[i] > 0 ? 1 : -1;
    }
    return 0;
  }

 private:
  std::array<double, 12> parts_{};
  std::size_t count_ = 0;
};

int exact_side(const OutlinePoint& a, const OutlinePoint& b, const OutlinePoint& c) {
  ExactSum sum;
  sum.add_product(a.y, b.z);
  sum.add_product(-a.z, b.y);
  sum.add_product(b.y, c.z);
  sum.add_product(-b.z, c.y);
  sum.add_product(c.y, a.z);
  sum.add_product(-c.z, a.y);
  return sum.sign();
}

}  // namespace

int side_of(const OutlinePoint& a, const OutlinePoint& b, const OutlinePoint& c) {
  const double left = (a.y - c.y) * (b.z - c.z), right = (a.z - c.z) * (b.y - c.y);
  const double difference = left - right;
  // Greater than the rounding errors of the four subtractions and of the two products.
  if (std::abs(difference) > 0x1p-50 * (std::abs(left) + std::abs(right))) {
    return difference > 0 ? 1 : -1;
  }
  return exact_side(a, b, c);
}

namespace {

/// Whether c, on the line through a and b, lies between them or on one of them.
bool is_between(const OutlinePoint& a, const OutlinePoint& b, const OutlinePoint& c) {
  return std::min(a.y, b.y) <= c.y && c.y <= std::max(a.y, b.y) && std::min(a.z, b.z) <= c.z &&
         c.z <= std::max(a.z, b.z);
}

/// Whether the closed segments from a to b and from c to d share a point.
bool share_a_point(const OutlinePoint& a, const OutlinePoint& b, const OutlinePoint& c,
                   const OutlinePoint& d) {
  if (std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y) ||
      std::max(a.z, b.z) < std::min(c.z, d.z) || std::max(c.z, d.z) < std::min(a.z, b.z)) {
    return false;
  }
  const int c_side = side_of(a, b, c), d_side = side_of(a, b, d);
  const int a_side = side_of(c, d, a), b_side = side_of(c, d, b);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  return (c_side == 0 && is_between(a, b, c)) || (d_side == 0 && is_between(a, b, d)) ||
         (a_side == 0 && is_between(c, d, a)) || (b_side == 0 && is_between(c, d, b));
}

/// Whether the edges from b to a and from b to c share more than b.
bool fold_back(const OutlinePoint& a, const OutlinePoint& b, const OutlinePoint& c) {
  return side_of(a, b, c) == 0 && (is_between(b, a, c) || is_between(b, c, a));
}

}  // namespace

std::optional<std::pair<std::size_t, std::size_t>> touching_edges(
    std::span<const OutlinePoint> polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t i_end = (i + 1) % n;
    if (fold_back(polygon[i], polygon[i_end], polygon[(i + 2) % n])) return std::pair(i, i_end);
    for (std::size_t j = i + 2; j < n; ++j) {
      const std::size_t j_end = (j + 1) % n;
      if (j_end == i) continue;  // neighbours
      if (share_a_point(polygon[i], polygon[i_end], polygon[j], polygon[j_end])) {
        return std::pair(i, j);
      }
    }
  }
  return std::nullopt;
}

namespace {

/// A polygon from which ears are cut: triangles of three corners in a row that hold no other one.
class EarClipper {
 public:
  explicit EarClipper(std::span<const OutlinePoint> polygon)
      : polygon_(polygon), before_(polygon.size()), after_(polygon.size()) {
    const auto n = static_cast<std::uint32_t>(polygon.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      before_[i] = (i + n - 1) % n;
      after_[i] = (i + 1) % n;
    }
  }

  std::vector<std::array<std::uint32_t, 3>> clip() {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::uint32_t at = 0;
    for (std::size_t left = polygon_.size(); left > 3; --left) {
      // A simple polygon has an ear, even one with flat corners (Meisters 1975).
      for (std::size_t tried = 0; !is_ear(at) && tried < left; ++tried) at = after_[at];
      triangles.push_back({before_[at], at, after_[at]});
      after_[before_[at]] = after_[at];
      before_[after_[at]] = before_[at];
      at = after_[after_[at]];  // so that no corner collects all ears
    }
    triangles.push_back({before_[at], at, after_[at]});
    return triangles;
  }

 private:
  bool is_ear(std::uint32_t at) const {
    const OutlinePoint &a = polygon_[before_[at]], &b = polygon_[at], &c = polygon_[after_[at]];
    if (side_of(a, b, c) <= 0) return false;
    for (std::uint32_t i = after_[after_[at]]; i != before_[at]; i = after_[i]) {
      const OutlinePoint& p = polygon_[i];
      if (side_of(a, b, p) >= 0 && side_of(b, c, p) >= 0 && side_of(c, a, p) >= 0) return false;
    }
    return true;
  }

  std::span<const OutlinePoint> polygon_;
  std::vector<std::uint32_t> before_, after_;  ///< neighbours of the corners that are left
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulated(std::span<const OutlinePoint> polygon) {
  return EarClipper(polygon).clip();
}

namespace {

std::string text_of(const OutlinePoint& p) {
  return "(" + format_number(p.y) + ", " + format_number(p.z) + ")";
}

void check_corners(std::span<const OutlinePoint> outline) {
  constexpr double kFarthest = 1e6;
  if (outline.size() < 3 || outline.size() > kMostOutlinePoints) {
    throw UsageError("an outline of " + counted(outline.size(), "corner") + "; expected 3 to " +
                     format_count(kMostOutlinePoints));
  }
  for (const OutlinePoint& p : outline) {
    if (!(std::abs(p.y) <= kFarthest && std::abs(p.z) <= kFarthest)) {
      throw UsageError("an outline with the corner " + text_of(p) +
                       "; expected numbers from -1e6 to 1e6");
    }
  }
}

/// The outline in its positive sense of rotation, which is to the left.
std::vector<OutlinePoint> turned_left(std::span<const OutlinePoint> outline) {
  std::vector<OutlinePoint> out(outline.begin(), outline.end());
  for (OutlinePoint& p : out) {
    // Below any length that matters, and where products would lose their last places
    constexpr double kTiny = 1e-100;
    if (std::abs(p.y) < kTiny) p.y = 0;
    if (std::abs(p.z) < kTiny) p.z = 0;
  }
  if (const auto edges = touching_edges(out)) {
    const auto edge = [&](std::size_t i) {
      return "from " + text_of(out[i]) + " to " + text_of(out[(i + 1) % out.size()]);
    };
    throw UsageError("an outline whose edges " + edge(edges->first) + " and " +
                     edge(edges->second) +
                     " cross or touch; expected one simple polygon with an area, without holes");
  }
  // At the corner with the least y, and of these with the least z, a simple polygon turns.
  const auto corner = static_cast<std::size_t>(
      std::ranges::min_element(out,
                               [](const OutlinePoint& a, const OutlinePoint& b) {
                                 return a.y < b.y || (a.y == b.y && a.z < b.z);
                               }) -
      out.begin());
  const std::size_t n = out.size();
  if (side_of(out[(corner + n - 1) % n], out[corner], out[(corner + 1) % n]) < 0) {
    std::ranges::reverse(out);
  }
  return out;
}

}  // namespace

Model outline_model(std::span<const OutlinePoint> outline, double rear, double front) {
  if (!(std::isfinite(rear) && std::isfinite(front) && rear < front)) {
    throw UsageError("a solid from x = " + format_number(rear) + " to " + format_number(front) +
                     "; expected its rear, and then its front at a greater x");
  }
  check_corners(outline);
  const std::vector<OutlinePoint> polygon = turned_left(outline);
  const auto n = static_cast<std::uint32_t>(polygon.size());
  std::vector<Vec3> vertices;
  for (const double x : {rear, front}) {
    for (const OutlinePoint& p : polygon) vertices.push_back({x, p.y, p.z});
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const auto& [a, b, c] : triangulated(polygon)) {
    triangles.push_back({c, b, a});
    triangles.push_back({n + a, n + b, n + c});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    triangles.push_back({i, next, n + next});
    triangles.push_back({i, n + next, n + i});
  }
  std::vector<std::uint32_t> solid_of(triangles.size(), 0);
  return {std::move(vertices), std::move(triangles), std::move(solid_of)};
}

Model box_model(double length, double width, double height) {
  for (const double side : {length, width, height}) {
    if (!(side > 0 && std::isfinite(side))) {
      throw UsageError("a box of " + format_number(length) + " x " + format_number(width) + " x " +
                       format_number(height) + " m; expected three lengths above 0");
    }
  }
  const double y = width / 2, z = height;
  const OutlinePoint outline[] = {{-y, 0}, {y, 0}, {y, z}, {-y, z}};
  return outline_model(outline, -length / 2, length / 2);
}

}  // namespace clearway
