#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/query.hpp"
#include "clearway/report.hpp"
#include "report/page.hpp"

namespace clearway {

/// A body that the page draws.
struct DrawnBody : MovingBody {
  Box box{};  ///< box of the model's points
  std::size_t shown_points = 0;

  /// The least distance of the body's points or triangles to a place, at a pose of the path: below
  /// 0 inside its solids, where it is minus the depth, as in a search. Infinity where the body has
  /// no pose there.
  double distance_to(const Vec3& place, std::uint32_t pose) const;
};

/// The bodies of the vehicle, or the model as the only one. All arguments outlive them.
std::vector<DrawnBody> drawn_bodies(const Model& model, const std::vector<Pose>& poses,
                                    const ReportOptions& options);

/// The box around the boxes of all bodies, each in its own frame.
Box box_around(std::span<const DrawnBody> bodies);

/// The points to draw, body after body, with the index of the body as their tag. At most `most`
/// points, the same number for each body. Sets shown_points.
std::vector<PagePoint> points_of_bodies(std::span<DrawnBody> bodies, const PageLattice& lattice,
                                        std::size_t most);

/// The most poses that the page shows, so few that the columns of all bodies together do not grow
/// with the number of bodies.
std::size_t most_shown_poses(std::size_t bodies);

}  // namespace clearway
