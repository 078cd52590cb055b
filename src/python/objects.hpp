#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/follow.hpp"
#include "clearway/model.hpp"
#include "clearway/query.hpp"
#include "clearway/store.hpp"
#include "python/arrays.hpp"
#include "python/python.hpp"
#include "python/values.hpp"

/// What several calls take: stores, models, bodies and queries as Python objects.
namespace clearway::python {

/// A store that several Python threads share. Calls on it take turns, because a store remembers
/// which of its cells it has checked.
struct SharedStore {
  explicit SharedStore(const std::filesystem::path& path)
      : SharedStore(std::make_shared<const Store>(path)) {}
  /// The store of a session, which stays open as long as this refers to it.
  explicit SharedStore(std::shared_ptr<const Store> opened)
      : kept(std::move(opened)), store(*kept) {}

  const std::shared_ptr<const Store> kept;
  const Store& store;
  std::timed_mutex turn;
};

/// Calls `call` with the store while no other call uses it. Called without the GIL. Throws
/// Interrupted where it is stopped while it waits.
template <typename Call>
auto in_turn(SharedStore& shared, StopFlag stop, Call call) {
  std::unique_lock lock(shared.turn, std::defer_lock);
  while (!lock.try_lock_for(std::chrono::milliseconds(50))) {
    if (*stop) throw Interrupted("stopped before the store was free");
  }
  return call(std::as_const(shared.store));
}

/// A Model is returned as it is, and anything else as points_array() converts it.
py::object model_object(const py::handle& object);

/// A copy of a model. object: one that model_object() returned. Throws InputError for numbers that
/// are not finite.
Model model_of(const py::object& object);

/// The size of a model in words, such as "12 model points" or "12 model triangles".
std::string model_words(const py::object& object);

/// How follow() moves a body, for the bodies that it tows.
struct Motion {
  std::string name;
  BodyMount mount;
  std::shared_ptr<const Motion> tower;  ///< null where no other body tows it
  Body own = {};                        ///< with BodyOwnPoses, its poses without its model
};

/// A Body, and what it knows of the path that it was placed on.
struct PlacedBody : Body {
  /// The path that follow() or read_vehicle() placed the body on. Null for a body that was made of
  /// its own poses.
  std::shared_ptr<const std::vector<Pose>> path = nullptr;
  /// Whether path_pose was not given, so that the body has one pose for each of the path's.
  bool has_all_poses = false;
  /// How follow() moved it. Null for other bodies, which tow along the curve through their poses.
  std::shared_ptr<const Motion> motion = nullptr;
};

/// The bodies of a query along this path. Throws UsageError where a body was placed on another
/// path, or has no path_pose and a number of poses that differs from the path's.
std::vector<Body> bodies_on(const std::vector<PlacedBody>& bodies, const std::vector<Pose>& path);

/// The argument `bodies` on this path.
inline std::vector<Body> bodies_on(const py::kwargs& given, const std::vector<Pose>& path) {
  return bodies_on(given["bodies"].cast<std::vector<PlacedBody>>(), path);
}

/// A query whose model and poses are Python objects.
struct ArrayQuery {
  QueryParameters parameters;
  /// The model that model_object() returned.
  py::object model;
  /// The poses that poses_array() returned.
  Doubles poses;
  bool allow_non_rigid = false;
  std::vector<PlacedBody> bodies = {};
};

/// The query with copies of model and poses, so that Python may change its own during the search.
Query query_of(const ArrayQuery& query);

/// Makes `asked` what the query is, but for the model, which stays.
void ask(const ArrayQuery& query, Query& asked);

/// Throws UsageError for a query that has no radius yet.
void require_radius(const ArrayQuery& query);

/// Throws InputError for a pose of the path or of a body that scales, shears or mirrors.
void require_rigid(const Query& query);

}  // namespace clearway::python
