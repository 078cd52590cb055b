#pragma once

#include <vector>

#include "clearway/box.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/query.hpp"
#include "clearway/stations.hpp"
#include "core/trajectory/follow/path_stations.hpp"

namespace clearway {

/// The overthrow of a body at each of its poses (docs/design/findings.md, "Overthrow"). path: of
/// the path that the body follows. box: the box of the body's model, in its own frame.
std::vector<Overthrow> overthrow_of(const PathStations& path, const MovingBody& body,
                                    const Box& box, Axis forward, Axis up);

}  // namespace clearway
