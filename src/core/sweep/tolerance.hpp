#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/query.hpp"
#include "core/geometry/box.hpp"

/// What a search within a tolerance t may do (docs/design/numerics.md, "Tolerance"): distances may
/// grow by t when model points and poses are left out, and whatever comes closer than about r + t
/// may be taken. Only experiments search within a tolerance; an answer of Clearway is exact.
namespace clearway {

/// The distance up to which a search within a tolerance looks, in metres: the greatest one at which
/// a point may be taken. Without a tolerance it is the radius.
double search_radius(double radius, double tolerance);

/// Indices of some of the poses, ascending: at each of the other poses no point of the box `model`
/// is farther than `most_motion` from where it is at one of these, rounding included. Equal
/// consecutive poses count as one, whatever most_motion is.
std::vector<std::uint32_t> kept_poses(std::span<const Pose> poses, const Box& model,
                                      double most_motion);

/// Indices of some of the points, ascending: each of the other points lies within `cover` of one of
/// these, rounding included. Equal points count as one, whatever the cover is. Takes 12 bytes a
/// point while it runs.
std::vector<std::uint32_t> kept_points(std::span<const Vec3> model, double cover);

/// A query with only as much of model and trajectory as a tolerance needs: half of the tolerance is
/// spent on each.
class ThinnedQuery {
 public:
  /// query: has a model; its data is not needed afterwards. tolerance: metres, above 0.
  ThinnedQuery(const Query& query, double tolerance);
  ThinnedQuery(const ThinnedQuery&) = delete;
  ThinnedQuery& operator=(const ThinnedQuery&) = delete;

  /// The thinned query, valid while this object lives.
  const Query& query() const { return query_; }

 private:
  Query query_;
};

}  // namespace clearway
