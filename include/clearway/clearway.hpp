#pragma once

/// The whole public interface of Clearway, which finds the points of a scanned environment that lie
/// within the search radius of a moving model. docs/guide/library.md walks through it.

#include "clearway/alignment.hpp"   // IWYU pragma: export
#include "clearway/answer.hpp"      // IWYU pragma: export
#include "clearway/axis.hpp"        // IWYU pragma: export
#include "clearway/body.hpp"        // IWYU pragma: export
#include "clearway/conflicts.hpp"   // IWYU pragma: export
#include "clearway/convert.hpp"     // IWYU pragma: export
#include "clearway/error.hpp"       // IWYU pragma: export
#include "clearway/file_unit.hpp"   // IWYU pragma: export
#include "clearway/follow.hpp"      // IWYU pragma: export
#include "clearway/ignored.hpp"     // IWYU pragma: export
#include "clearway/ledger.hpp"      // IWYU pragma: export
#include "clearway/line.hpp"        // IWYU pragma: export
#include "clearway/merge.hpp"       // IWYU pragma: export
#include "clearway/model.hpp"       // IWYU pragma: export
#include "clearway/outline.hpp"     // IWYU pragma: export
#include "clearway/progress.hpp"    // IWYU pragma: export
#include "clearway/query.hpp"       // IWYU pragma: export
#include "clearway/report.hpp"      // IWYU pragma: export
#include "clearway/result.hpp"      // IWYU pragma: export
#include "clearway/search.hpp"      // IWYU pragma: export
#include "clearway/section.hpp"     // IWYU pragma: export
#include "clearway/seen.hpp"        // IWYU pragma: export
#include "clearway/session.hpp"     // IWYU pragma: export
#include "clearway/shard.hpp"       // IWYU pragma: export
#include "clearway/shift.hpp"       // IWYU pragma: export
#include "clearway/smooth.hpp"      // IWYU pragma: export
#include "clearway/stations.hpp"    // IWYU pragma: export
#include "clearway/store.hpp"       // IWYU pragma: export
#include "clearway/trajectory.hpp"  // IWYU pragma: export
#include "clearway/unsearched.hpp"  // IWYU pragma: export
#include "clearway/unseen.hpp"      // IWYU pragma: export
#include "clearway/vehicle.hpp"     // IWYU pragma: export
