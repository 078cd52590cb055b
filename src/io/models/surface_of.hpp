#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <utility>
#include <vector>

#include "clearway/model.hpp"
#include "io/models/model_input.hpp"

namespace clearway {

struct FlatPlace {
  double x, y;
};

/// The half-plane of points with a x + b y + c >= 0.
struct HalfPlane {
  double a, b, c;

  double height(const FlatPlace& p) const { return a * p.x + b * p.y + c; }
};

/// A convex polygon in a plane. With two corners it is a segment, with none it is empty.
class FlatPolygon {
 public:
  static constexpr std::size_t kMostCorners = 24;

  FlatPolygon() = default;
  FlatPolygon(std::initializer_list<FlatPlace> corners) {
    for (const FlatPlace& corner : corners) add(corner);
  }

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  const FlatPlace* begin() const { return corners_.data(); }
  const FlatPlace* end() const { return corners_.data() + size_; }

  /// The part of the polygon within the half-plane. What is left out is the hull of places that the
  /// computed heights put outside. The whole polygon is returned where the part would have too many
  /// corners. Source: Sutherland and Hodgman, Reentrant polygon clipping, 1974.
  FlatPolygon clipped(const HalfPlane& half) const {
    FlatPolygon kept;
    for (std::size_t i = 0; i < size_; ++i) {
      const FlatPlace& a = corners_[i];
      const FlatPlace& b = corners_[(i + 1) % size_];
      const double height_a = half.height(a), height_b = half.height(b);
      if (kept.size_ + 2 > kMostCorners) return *this;  // happens only where rounding bends a side
      if (height_a >= 0) kept.add(a);
      if ((height_a >= 0) != (height_b >= 0)) {
        const double t = height_a / (height_a - height_b);
        kept.add({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
      }
    }
    return kept;
  }

  FlatPolygon moved_by(const FlatPlace& way) const {
    FlatPolygon moved;
    for (const FlatPlace& corner : *this) moved.add({corner.x + way.x, corner.y + way.y});
    return moved;
  }

  /// Two parts that together make up the polygon, cut across the longer side of its box.
  std::pair<FlatPolygon, FlatPolygon> halves() const {
    FlatPlace lo = corners_[0], hi = corners_[0];
    for (const FlatPlace& corner : *this) {
      lo = {std::min(lo.x, corner.x), std::min(lo.y, corner.y)};
      hi = {std::max(hi.x, corner.x), std::max(hi.y, corner.y)};
    }
    const bool across_x = hi.x - lo.x >= hi.y - lo.y;
    const HalfPlane half =
        across_x ? HalfPlane{1, 0, -(lo.x + hi.x) / 2} : HalfPlane{0, 1, -(lo.y + hi.y) / 2};
    return {clipped(half), clipped({-half.a, -half.b, -half.c})};
  }

 private:
  void add(const FlatPlace& corner) { corners_[size_++] = corner; }

  std::array<FlatPlace, kMostCorners> corners_;
  std::size_t size_ = 0;
};

/// The triangles of a mesh and the vertices that they use, in the order of the file. Appends
/// warnings, except those of the input.
TriangleMesh kept_surface(const ModelInput& input, std::vector<Message>& messages);

/// The mesh that kept_surface() gives, with all notes and warnings about the input too. Throws
/// InputError for a file without triangles.
TriangleMesh surface_of(const ModelInput& input, const ModelOptions& options,
                        std::vector<Message>& messages);

}  // namespace clearway
