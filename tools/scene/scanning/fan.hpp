#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/sites/world.hpp"

namespace clearway::scene {

/// The rectangle in which an upright plane through the scanner cuts a prism, relative to the
/// scanner. It never lies around the scanner, nor across the line straight down from it.
struct Rectangle {
  double near_h, far_h, low_w, high_w;  ///< h along the plane's direction, near_h < far_h
  const Prism* prism;
};

/// Finds the rectangles of all `prisms` that the plane through `scanner` in direction `azimuth`
/// cuts.
void cut_prisms(std::span<const Prism> prisms, const PathPoint& scanner, const SineCosine& azimuth,
                std::vector<Rectangle>& out);

/// Rays at rising angles from one point in one plane, and the first thing that each meets.
class Fan {
 public:
  /// Ray k points at begin + (k + jitter) * (end - begin) / count, jitter in [0, 1) from `random`
  /// at first_counter + k.
  void aim(double begin, double end, std::size_t count, const Random& random,
           std::uint64_t first_counter);
  void meet_room(const Room& room, const PathPoint& scanner, const SineCosine& azimuth);
  void meet_rectangle(const Rectangle& rectangle);

  std::size_t size() const { return ray_h_.size(); }
  double ray_h(std::size_t k) const { return ray_h_[k]; }  ///< unit direction
  double ray_w(std::size_t k) const { return ray_w_[k]; }
  /// The inverse of the distance at which ray k meets something; 0 where it meets nothing.
  double inverse_distance(std::size_t k) const { return inverse_distance_[k]; }
  const Wall* wall(std::size_t k) const { return wall_[k] < 0 ? nullptr : &room_->walls[wall_[k]]; }
  const Prism* prism(std::size_t k) const { return prism_[k]; }

 private:
  double begin_ = 0, step_ = 1;
  const Room* room_ = nullptr;
  std::vector<double> ray_h_, ray_w_, inverse_h_, inverse_w_;
  std::vector<double> inverse_distance_;
  std::vector<int> wall_;
  std::vector<const Prism*> prism_;
};

}  // namespace clearway::scene
