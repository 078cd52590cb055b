#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "report/drawn_bodies.hpp"

namespace clearway {

/// The centres of the bodies' boxes along the path, at places some distance apart, to find what is
/// near the path. They are as accurate as a picture needs, not as a search does.
class PathPlaces {
 public:
  struct Place {
    Vec3 centre;
    double top;  ///< greatest z of the box there
  };

  /// bodies: at least one.
  explicit PathPlaces(std::span<const DrawnBody> bodies);

  /// Half the diagonal of the largest box.
  double half_diagonal() const { return half_diagonal_; }
  /// The distance from the centre of every body beyond which points are not on the page.
  double reach() const { return reach_; }
  /// The distance up to which points are shown equally densely; beyond it they are thinned more and
  /// more.
  double dense_reach() const { return dense_reach_; }
  std::span<const Place> places() const { return places_; }
  /// Sets `out` to the indices of the places that are at most reach() from the box.
  void near(const Box& box, std::vector<std::uint32_t>& out) const;
  /// Removes from `places` those that are nearest to no place of the box. They are in their order.
  void keep_nearest(const Box& box, std::vector<std::uint32_t>& places) const;
  /// The distance of the box to the nearest of the places in `among`; infinity where there are
  /// none.
  double distance(const Box& box, std::span<const std::uint32_t> among) const;
  /// The place in `among` that is nearest to a point. `among` is not empty.
  const Place& nearest(const Vec3& point, std::span<const std::uint32_t> among) const;

 private:
  void add(const DrawnBody& body);

  double half_diagonal_ = 0, reach_, dense_reach_;
  std::vector<Place> places_;
};

}  // namespace clearway
