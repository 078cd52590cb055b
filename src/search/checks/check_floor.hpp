#pragma once

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/messages/messages.hpp"
#include "io/scans/length_unit.hpp"
#include "search/kept_models.hpp"

namespace clearway {

/// Checks the floor of a body, if it has one. Throws UsageError where nothing of the body is as
/// high, so that nothing could be judged. Warns where it leaves out much of the body, as where its
/// file has the origin in its middle: "floor-high"; and where the body does not stand upright at
/// most poses, so that its floor is no height above the ground: "floor-axis". radius: within which
/// points are looked for. metre: its length in the environment's unit.
void check_floor(const MovingBody& body, double radius, LengthUnit unit, double metre,
                 MessageLog& log);

/// Looks at 16 poses of a body without a floor, before anything is searched. Notes where at more
/// than half of them points under the body, in its lowest 0.3 m, are within the radius, as the
/// ground is under wheels: "ground-collides", with the floor that leaves them out. more: by how
/// much the search judges below a floor, because of errors and cubes. Does not look where the query
/// ignores points, which the ground may be among. metre: its length in the environment's unit.
/// index: of the body's model. Damaged cells are left to the search, which reports them.
void look_for_ground(const PackedCloud& cloud, LengthUnit unit, double metre,
                     const QueryParameters& query, double more, const MovingBody& body,
                     const ModelIndex& index, MessageLog& log);

}  // namespace clearway
