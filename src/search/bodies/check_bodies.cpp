#include <set>
#include <string>

#include "clearway/error.hpp"
#include "core/query/body_numbers.hpp"
#include "core/query/hit_set.hpp"
#include "search/check_query.hpp"

namespace clearway {
namespace {

[[noreturn]] void refuse_body(const Body& body, const std::string& what) {
  throw InputError("body " + body.name + ": " + what);
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
      throw UsageError("body " + body.name + " has no pose between poses " +
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
  if (chosen_engine(options) != Engine::kSweep) {
    throw UsageError(std::string("engine ") + name_of(options.engine) +
                         " searches one model, and no vehicle of several bodies",
                     Remedy::kSweepEngine);
  }
  if (query.tolerance > 0) {
    throw UsageError("a tolerance and a vehicle of several bodies cannot be combined");
  }
  if (!query.model.empty()) {
    throw InputError("a query has either a model or bodies");
  }
  if (query.bodies.size() > kMostBodies) {
    throw InputError("the vehicle has " + std::to_string(query.bodies.size()) +
                     " bodies, expected at most " + std::to_string(kMostBodies));
  }
  if (BodyNumbers(query).end(query.poses.size()) >= HitSet::kNever) {
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

}  // namespace clearway
