#pragma once

#include <pybind11/numpy.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/progress.hpp"
#include "clearway/query.hpp"
#include "clearway/store.hpp"
#include "python/arrays.hpp"

namespace clearway::python {

/// A store remembers which of its cells it has checked, so that calls on it take turns.
struct SharedStore {
  explicit SharedStore(const std::filesystem::path& path) : store(path) {}

  Store store;
  std::timed_mutex turn;
};

/// Calls `call` with the store, alone. Without the GIL. Throws Interrupted where it is stopped
/// while it waits.
template <typename Call>
auto in_turn(SharedStore& shared, StopFlag stop, Call call) {
  std::unique_lock lock(shared.turn, std::defer_lock);
  while (!lock.try_lock_for(std::chrono::milliseconds(50))) {
    if (*stop) throw Interrupted("stopped before the store was free");
  }
  return call(std::as_const(shared.store));
}

/// A Body, and what it knows of the path that it was placed on.
struct PlacedBody : Body {
  /// That follow() and read_vehicle() placed it on. Null: it was made of its own poses.
  std::shared_ptr<const std::vector<Pose>> path = nullptr;
  bool has_all_poses = false;  ///< path_pose was not given: it has each of the path's
};

/// The bodies of a query on that path. Throws UsageError where one of them was placed on another
/// path, or lacks poses without saying which.
std::vector<Body> bodies_on(const std::vector<PlacedBody>& bodies, const std::vector<Pose>& path);

/// A Query whose model and poses are Python's.
struct ArrayQuery {
  QueryParameters parameters;
  py::object model;  ///< as model_object() has it
  Doubles poses;     ///< as poses_array() has them
  bool allow_non_rigid = false;
  std::vector<PlacedBody> bodies = {};
};

/// With copies of model and poses, so that Python may change them meanwhile.
Query query_of(const ArrayQuery& query);

}  // namespace clearway::python
