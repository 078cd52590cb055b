#include "search/check_query.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <type_traits>

#include "clearway/error.hpp"
#include "core/describe/query.hpp"
#include "core/geometry/inside.hpp"
#include "core/query/body_numbers.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/search_result.hpp"
#include "core/util/format.hpp"
#include "io/scans/length_unit.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

double metre_in_units_of(double metres) { return metres > 0 ? 1 / metres : 1; }

double metre_of(const StoreReader& store) {
  return metre_in_units_of(metres_of(store.metadata().unit));
}

namespace {

[[noreturn]] void refuse_engine(Engine engine, const std::string& what) {
  throw UsageError(std::string("engine ") + name_of(engine) +
                       " finds the points that collide at the poses, and nothing else: expected "
                       "engine sweep for " +
                       what,
                   Remedy::kSweepEngine);
}

[[noreturn]] void refuse_body(const Body& body, const std::string& what) {
  throw InputError(body_words(body.name) + ": " + what);
}

void check_name(const Body& body, std::set<std::string>& names) {
  if (body.name.empty() || body.name.find('\n') != std::string::npos ||
      body.name.find('\0') != std::string::npos || body.name.size() > kMostNameBytes) {
    refuse_body(body, "expected a name of at most " + std::to_string(kMostNameBytes) +
                          " bytes in one line");
  }
  if (!names.insert(body.name).second) refuse_body(body, "another body has this name too");
}

void check_poses(const Body& body, const Query& query) {
  if (body.poses.size() != body.path_pose.size()) {
    refuse_body(body, "has " + std::to_string(body.poses.size()) + " poses, and says of " +
                          std::to_string(body.path_pose.size()) +
                          " which pose of the path they are");
  }
  for (std::size_t i = 0; i < body.path_pose.size(); ++i) {
    const bool ascends = i == 0 || body.path_pose[i] > body.path_pose[i - 1];
    if (!ascends || body.path_pose[i] >= query.poses.size()) {
      refuse_body(body, "its poses are not in the order of the path");
    }
    if (query.between_poses && i > 0 && body.path_pose[i] != body.path_pose[i - 1] + 1) {
      throw UsageError(body_words(body.name) + " has no pose between poses " +
                       std::to_string(body.path_pose[i - 1]) + " and " +
                       std::to_string(body.path_pose[i]) +
                       " of the path, so that its way there is not known: search at poses, or "
                       "split the path");
    }
  }
}

}  // namespace

void check_bodies(const Query& query, const SearchOptions& options) {
  if (query.bodies.empty()) return;
  if (options.engine != Engine::kSweep) refuse_engine(options.engine, "vehicles of several bodies");
  if (!query.model.empty()) {
    throw InputError("a query has either a model or bodies");
  }
  if (query.bodies.size() > kMostBodies) {
    throw InputError("the vehicle has " + std::to_string(query.bodies.size()) +
                     " bodies, expected at most " + std::to_string(kMostBodies));
  }
  if (BodyNumbers(query).end(query.poses.size()) >= kNoPose) {
    throw InputError("the path has " + std::to_string(query.poses.size()) + " poses for " +
                     std::to_string(query.bodies.size()) +
                     " bodies, expected fewer than 2^32 - 1 poses of bodies together");
  }
  std::set<std::string> names;
  for (const Body& body : query.bodies) {
    check_name(body, names);
    check_poses(body, query);
    if (body.model.is_surface()) check_surface(query, options);
  }
}

namespace {

/// Throws UsageError where seen space is asked for in part, or cannot be known.
void check_seen(const QueryParameters& query) {
  const QueryParameters usual;
  if (!query.seen && (query.seen_cube != usual.seen_cube || query.seen_min != usual.seen_min)) {
    throw UsageError("a cube or a least group of seen space: expected seen space to be asked for",
                     Remedy::kNone);
  }
  if (!query.seen) return;
  if (query.seen_min == 0) throw UsageError("the least group of unseen cubes has at least 1 cube");
}

/// Refuses errors that are no errors, and a floor that is no height.
void check_budget(const QueryParameters& query) {
  for_each_field(kQueryValues, [&](const auto& field) {
    using Value = typename std::decay_t<decltype(field)>::Value;
    if constexpr (std::is_same_v<Value, std::optional<double>>) {
      const std::optional<double>& value = field.of(query);
      const bool is_any = field.range == FieldRange::kAny;
      if (!value || (std::isfinite(*value) && (is_any || *value >= 0))) return;
      throw UsageError(std::string("the ") + field.topic + " is " + std::to_string(*value) +
                       ", expected a finite number" + (is_any ? "" : ", 0 or above"));
    } else if constexpr (std::is_same_v<Value, double>) {
      if (!field.is_of_budget || query.has_budget() || field.is_default(query)) return;
      throw UsageError(std::string("the ") + field.topic +
                       " is of an error budget, and no error is given: expected an error of the "
                       "scan, the registration, the poses, the angles or the model");
    }
  });
  if (!query.has_budget()) return;
  if (!(query.sigmas >= 0) || !std::isfinite(query.sigmas)) {
    throw UsageError("the number of standard deviations has to be finite, 0 or above");
  }
  if (!(query.gap >= 0) || !std::isfinite(query.gap)) {
    throw UsageError("the gap has to be a finite number of metres above 0, or 0 for the usual one");
  }
}

void check_numbers(const QueryParameters& query, const SearchOptions& options) {
  const auto check = [](const char* name, double value, bool may_be_zero) {
    if (std::isfinite(value) && (value > 0 || (may_be_zero && value == 0))) return;
    throw UsageError(std::string(name) + " has to be a finite number of metres above 0");
  };
  for_each_field(kQueryValues, [&](const auto& field) {
    if constexpr (std::is_same_v<typename std::decay_t<decltype(field)>::Value, double>) {
      const std::string topic = std::string("the ") + field.topic;
      if (!field.is_of_budget) check(topic.c_str(), field.of(query), !field.is_required);
    }
  });
  check_budget(query);
  if (options.threads < 0) throw UsageError("the number of threads cannot be negative");
  if (!(options.journal_interval_seconds >= 0)) {
    throw UsageError("the journal's interval has to be 0 seconds or more");
  }
  if (options.shard && !options.shard->is_valid()) {
    throw UsageError("shard " + to_string(*options.shard) +
                     ": expected i/n with i from 1 to n, and n at most " +
                     std::to_string(Shard::kMost));
  }
  if (options.overwrite && options.resume) {
    throw UsageError("a run either resumes or overwrites");
  }
}

/// Throws UsageError where an engine of the paper is asked for more than the paper's question, or
/// for a device that it does not have.
void check_engine(const QueryParameters& query, const SearchOptions& options) {
  const Engine engine = options.engine;
  if (engine == Engine::kSweep) return;
  const std::pair<bool, const char*> more[] = {{query.between_poses, "motion between poses"},
                                               {query.first_pose, "first poses"},
                                               {query.clearance > 0, "clearances"},
                                               {query.profile > 0, "a profile"},
                                               {query.floor.has_value(), "a floor"},
                                               {query.has_budget(), "errors"},
                                               {query.depth, "depths"},
                                               {query.seen, "seen space"}};
  for (const auto& [is_asked, what] : more) {
    if (is_asked) refuse_engine(engine, what);
  }
  if (engine == Engine::kKdtree && (options.device == Device::kCuda || !options.gpus.empty() ||
                                    options.device_memory_bytes > 0)) {
    throw UsageError(
        "engine kdtree runs on the CPU alone: GPUs and device memory are of the "
        "engines sweep and grid",
        Remedy::kSweepEngine);
  }
}

/// A part has only some of the points that are not free, so it cannot say which points are.
void refuse_depth_in_shard(const QueryParameters& query, const SearchOptions& options) {
  if (!query.depth || !options.shard) return;
  throw UsageError(
      "depths are not found in shards: which point is free is only known when all of them are "
      "searched. Search the whole query at once");
}

void check_ignored(const QueryParameters& query) {
  for (const Box& box : query.ignore_boxes) {
    for (int k = 0; k < 3; ++k) {
      if (!std::isfinite(box.lo[k]) || !std::isfinite(box.hi[k])) {
        throw UsageError("an ignored box has to have finite corners");
      }
      if (box.lo[k] <= box.hi[k]) continue;
      throw UsageError("the ignored box " + box_text(box) +
                       " has its corners the wrong way round: expected the least x, y and z first");
    }
  }
}

void check_solids(const std::string& what, const Model& of) {
  if (!of.is_solid()) return;
  if (of.solid_of.size() != of.triangles.size()) {
    throw InputError(what + " has " + std::to_string(of.triangles.size()) +
                     " triangles and the solids of " + std::to_string(of.solid_of.size()) +
                     ", expected one for each");
  }
  if (const std::uint64_t solids = of.solid_count(); solids > of.triangles.size()) {
    throw InputError(what + " names solid " + std::to_string(solids - 1) +
                     ", expected numbers below that of its triangles");
  }
  for (const Vec3& corner : of.vertices) {
    for (int k = 0; k < 3; ++k) {
      if (std::abs(corner[k]) < SolidLattice::kMostSide / 2) continue;
      throw InputError("a corner of " + what + " has the coordinate " + std::to_string(corner[k]) +
                       ", expected one below 5e149 m for a model with solids");
    }
  }
}

void check_model_size(const std::string& what, const Model& of) {
  if (of.empty()) throw InputError(what + " has no points");
  if (of.vertices.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw InputError(what + " has " + std::to_string(of.vertices.size()) +
                     " points, expected fewer than 2^32");
  }
  if (of.triangles.size() >= std::numeric_limits<std::uint32_t>::max() / 2) {
    throw InputError(what + " has " + std::to_string(of.triangles.size()) +
                     " triangles, expected fewer than 2^31");
  }
  for (std::size_t i = 0; i < of.triangles.size(); ++i) {
    for (const std::uint32_t corner : of.triangles[i]) {
      if (corner < of.vertices.size()) continue;
      throw InputError("triangle " + std::to_string(i) + " of " + what + " has the corner " +
                       std::to_string(corner) + ", expected one below " +
                       std::to_string(of.vertices.size()));
    }
  }
  check_solids(what, of);
}

/// A height above the floor exists only where the rotation has an inverse.
void check_floor(const MovingBody& body, bool is_alone) {
  if (!body.floor) return;
  const std::string what = is_alone ? "" : body_words(body.name) + ": ";
  if (!std::isfinite(*body.floor)) {
    throw UsageError(what + "the floor has to be a finite number of metres");
  }
  for (std::size_t i = 0; i < body.poses.size(); ++i) {
    if (std::isfinite(1 / PullBack(body.poses[i]).determinant)) continue;
    throw InputError(what + "the rotation of pose " + std::to_string(i) +
                     " has no inverse, so that heights above a floor are not known there");
  }
}

}  // namespace

void check_query(const QueryParameters& query, const SearchOptions& options) {
  check_numbers(query, options);
  check_ignored(query);
  check_engine(query, options);
  check_seen(query);
  refuse_depth_in_shard(query, options);
  if (query.clearance > 0 && query.between_poses) {
    throw UsageError(
        "clearances and motion between poses cannot be combined: clearances are at poses");
  }
  if (query.profile > 0 && query.between_poses) {
    throw UsageError(
        "a profile and motion between poses cannot be combined: a profile is at poses");
  }
  check_gpus(options);
}

void check_gpus(const SearchOptions& options) {
  if (std::set(options.gpus.begin(), options.gpus.end()).size() < options.gpus.size()) {
    throw UsageError("a GPU is named twice");
  }
  if (options.device == Device::kCpu &&
      (!options.gpus.empty() || options.device_memory_bytes > 0)) {
    throw UsageError("GPUs and device memory are of device cuda", Remedy::kCudaDevice);
  }
}

void check_surface(const QueryParameters& query, const SearchOptions& options) {
  if (options.engine != Engine::kSweep) {
    throw UsageError(std::string("engine ") + name_of(options.engine) +
                         " searches models of points, and this model is the surface of a mesh, "
                         "which engine sweep searches",
                     Remedy::kModelPoints);
  }
  if (query.between_poses) {
    throw UsageError(
        "motion between poses is searched for models of points, and this model is the surface of "
        "a mesh",
        Remedy::kModelPoints);
  }
}

void check_sizes(const Query& query) {
  constexpr std::uint64_t kEnd = std::uint64_t{1} << 31;  // trees have up to 2 n - 1 nodes
  if (query.poses.size() >= kEnd) {
    throw InputError("the trajectory has " + std::to_string(query.poses.size()) +
                     " poses, expected fewer than " + std::to_string(kEnd));
  }
  for (const MovingBody& body : moving_bodies(query)) {
    const bool is_alone = query.bodies.empty();
    check_model_size(is_alone ? "the model" : body_words(body.name), body.model);
    check_floor(body, is_alone);
  }
}

}  // namespace clearway
