#pragma once

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/messages/messages.hpp"
#include "io/scans/length_unit.hpp"
#include "search/kept_models.hpp"

namespace clearway {

/// Warns where a body with a floor does not stand upright at most poses: "floor-axis". Its floor
/// is then no height above the ground.
void check_floor_axis(const MovingBody& body, MessageLog& log);

/// Looks at 16 poses of a body without a floor, before anything is searched. Notes where at more
/// than half of them points under the body, in its lowest 0.3 m, are within the radius, as the
/// ground is under wheels: "ground-collides", with the floor that leaves them out. Does not look
/// where the query ignores points, which the ground may be among. metre: its length in the
/// environment's unit. index: of the body's model. Damaged cells are left to the search, which
/// reports them.
void look_for_ground(const PackedCloud& cloud, LengthUnit unit, double metre,
                     const QueryParameters& query, const MovingBody& body, const ModelIndex& index,
                     MessageLog& log);

}  // namespace clearway
