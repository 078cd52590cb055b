#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/box.hpp"
#include "clearway/report.hpp"
#include "report/packed_points.hpp"

namespace clearway {

/// A rigid thing that the page draws: the model, or a body of a vehicle.
struct DrawnBody {
  std::string name;  ///< empty for the model
  const Model& model;
  std::span<const Pose> poses;
  std::span<const std::uint32_t> path_pose;  ///< as Body has it; none: poses are the path's
  Box box{};                                 ///< of the model's points
  std::size_t shown_points = 0;

  /// At a pose of the path; null where it is not there.
  const Pose* pose_at(std::uint32_t pose) const;
  /// The least distance of its points or triangles to a place, where it is there; else infinity.
  /// Inside its solids the depth, below 0: as a search has it.
  double distance_to(const Vec3& place, std::uint32_t pose) const;
};

/// The bodies of the vehicle, or the model as the only one. All arguments outlive it.
std::vector<DrawnBody> drawn_bodies(const Model& model, const std::vector<Pose>& poses,
                                    const ReportOptions& options);

/// Around all, each in its own frame.
Box box_around(std::span<const DrawnBody> bodies);

/// Points to draw, body after body; their tag is the body. Sets shown_points. At most `most`,
/// evenly of all bodies.
std::vector<PagePoint> points_of_bodies(std::span<DrawnBody> bodies, const PageLattice& lattice,
                                        std::size_t most);

/// Columns body.there (1 where the body has a pose), body.x to body.z, body.r0 to body.r8: of each
/// body one after the other, at the shown poses.
void append_body_columns(std::span<const DrawnBody> bodies, std::span<const std::uint32_t> shown,
                         const PageLattice& lattice, std::vector<PageColumn>& columns);

/// So many poses are shown that those of all bodies together stay of one size.
std::size_t most_shown_poses(std::size_t bodies);

}  // namespace clearway
