#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "report/drawn_bodies.hpp"

namespace clearway {

/// Where the middles of the bodies' boxes are along the path, at places some way apart: for what is
/// near the path. A picture's accuracy, not a search's.
class PathPlaces {
 public:
  struct Place {
    Vec3 centre;
    double top;  ///< greatest z of the box there
  };

  /// One body at least.
  explicit PathPlaces(std::span<const DrawnBody> bodies);

  double half_diagonal() const { return half_diagonal_; }  ///< of the largest box
  /// Points farther than this from the middle of every body are not on the page.
  double reach() const { return reach_; }
  /// Up to this distance all are worth the same, and less and less beyond.
  double dense_reach() const { return dense_reach_; }
  std::span<const Place> places() const { return places_; }
  /// Indices of the places at most reach() from the box.
  void near(const Box& box, std::vector<std::uint32_t>& out) const;
  /// Distance of the box to the nearest of these places; infinity for none.
  double distance(const Box& box, std::span<const std::uint32_t> among) const;
  /// The nearest of them to a point; there is one at least.
  const Place& nearest(const Vec3& point, std::span<const std::uint32_t> among) const;

 private:
  void add(const DrawnBody& body);

  double half_diagonal_ = 0, reach_, dense_reach_;
  std::vector<Place> places_;
};

/// Of the model's box at a pose.
Vec3 box_centre_at(const Box& model, const Pose& pose);

}  // namespace clearway
