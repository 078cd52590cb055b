#include "findings/check_conflicts.hpp"

#include <cmath>
#include <string>

#include "core/geometry/axes.hpp"
#include "core/messages/messages.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/files/xxh64.hpp"
#include "io/paths/content_hash.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {
namespace {

/// The shortest stretch in metres, so that stretches of any path are counted without rounding.
constexpr double kLeastSplit = 1e-9;

void check_options(const ConflictOptions& options) {
  if (!(options.gap >= 0) || !std::isfinite(options.gap)) {
    throw UsageError("a gap of " + format_number(options.gap) +
                     " m; expected a finite length above 0, or 0 for the usual one");
  }
  if (!(options.split >= 0) || !std::isfinite(options.split)) {
    throw UsageError("stretches of " + format_number(options.split) +
                     " m; expected a finite length, or 0 for none");
  }
  if (options.split > 0 && options.split < kLeastSplit) {
    throw UsageError("stretches of " + format_number(options.split) + " m; expected " +
                     format_number(kLeastSplit) + " m or more, or 0 for none");
  }
  if (!std::isfinite(options.chainage_start)) {
    throw UsageError("a chainage of " + format_number(options.chainage_start) +
                     " m at the first pose; expected a finite one");
  }
  if (along_one_line(options.forward, options.up)) {
    throw UsageError("forward and up lie along the same axis; expected two different axes");
  }
}

void check_hash(const ResultReader& result, const char* what, std::uint64_t is,
                std::uint64_t searched, Remedy remedy) {
  if (is == searched) return;
  throw InputError(result.name() + ": is the result of another " + what + " (hash " +
                       hash_text(searched) + ", given " + hash_text(is) + ")",
                   remedy);
}

void check_stations(const std::vector<Pose>& poses, std::span<const double> station) {
  if (station.empty() || station.size() == poses.size()) return;
  throw UsageError(counted(station.size(), "station") + " for " + counted(poses.size(), "pose") +
                   "; expected one for each pose, or none");
}

}  // namespace

void check_conflicts(const ResultReader& result, const std::vector<Pose>& poses,
                     const ConflictOptions& options) {
  check_options(options);
  check_axes(result, options);
  const ResultHeader& header = result.header();
  if (!header.first_pose) {
    throw UsageError(result.name() +
                         ": has no first poses, which say where along the path a "
                         "conflict is",
                     Remedy::kAskForFirstPose);
  }
  const std::uint64_t hash = hash_of_trajectory(poses);
  if (poses.size() == header.poses && hash == header.trajectory_hash) {
    check_stations(poses, options.station);
    if (!options.bodies.empty()) check_bodies_of(result, options.bodies);
    return;
  }
  refuse(result.name(),
         "was searched along another trajectory: of " + counted(header.poses, "pose") +
             " with the hash " + hash_text(header.trajectory_hash) + ". The one given has " +
             format_count(poses.size()) + " with the hash " + hash_text(hash),
         Remedy::kSameTrajectory);
}

void check_axes(const ResultReader& result, const ConflictOptions& options) {
  const ModelAxes kept = result.header().notes.model_axes;
  const ModelAxes asked{options.forward, options.up};
  if (!kept.need_turn() || !asked.need_turn()) return;
  throw UsageError(result.name() + ": its search turned the model, whose file had " +
                   name_of(kept.forward) + " ahead and " + name_of(kept.up) +
                   " up, so that now x points ahead and z up; expected no other axes, and " +
                   name_of(asked.forward) + " ahead and " + name_of(asked.up) + " up were given");
}

void check_bodies_of(const ResultReader& result, std::span<const Body> bodies) {
  const ResultHeader& header = result.header();
  if (header.bodies.empty()) {
    refuse(result.name(), "is the result of one model, and a vehicle of several bodies is given");
  }
  check_hash(result, "vehicle", hash_of_bodies(bodies), header.model_hash, Remedy::kSameModel);
}

void check_searched(const ResultReader& result, const StoreReader& store, const Searched& given) {
  const ResultHeader& header = result.header();
  check_hash(result, "environment", store.metadata().points_hash, header.environment_hash,
             Remedy::kSameEnvironment);
  if (store.metadata().crs_wkt != header.crs_wkt) {
    throw InputError(result.name() + ": names another coordinate reference system than the store",
                     Remedy::kSameEnvironment);
  }
  if (given.bodies.empty() && !header.bodies.empty()) {
    throw InputError(result.name() +
                     ": is the result of a vehicle of several bodies, and one model is given");
  }
  if (given.bodies.empty()) {
    check_hash(result, "model", hash_of_model(given.model), header.model_hash, Remedy::kSameModel);
  } else {
    check_bodies_of(result, given.bodies);
  }
  check_hash(result, "trajectory", hash_of_trajectory(given.poses), header.trajectory_hash,
             Remedy::kSameTrajectory);
}

namespace {

constexpr double kMostOfThePath = 0.5;

/// Such as "0.02 to 0.1 m below" or "0.1 m below to 0.3 m above".
std::string heights_text(double from, double to, const std::string& symbol) {
  const auto text = [](double height) { return format_brief(std::abs(height)); };
  const std::string unit = " " + symbol, above = unit + " above", below = unit + " below";
  if (text(from) == text(to) && (from < 0) == (to < 0)) {
    return text(from) + (from < 0 ? below : above);
  }
  if (to < 0) return text(to) + " to " + text(from) + below;
  return text(from) + (from < 0 ? below : "") + " to " + text(to) + above;
}

}  // namespace

double ground_height(LengthUnit unit) {
  constexpr double kGround = 0.5;  // metres
  const double metres = metres_of(unit);
  return metres > 0 ? kGround / metres : kGround;
}

bool spans_most_of_the_path(const Conflicts& conflicts) {
  const double length = conflicts.longest_group;
  return length > 0 && length >= kMostOfThePath * conflicts.path_length;
}

std::vector<Message> conflict_warnings(const Conflicts& conflicts, LengthUnit unit) {
  if (!spans_most_of_the_path(conflicts)) return {};
  const std::string symbol = symbol_of(unit);
  Message message =
      warning("one-long-conflict",
              "one group of " + counted(conflicts.longest_group_points, "point") + " spans " +
                  format_brief(conflicts.longest_group) + " " + symbol + " of " +
                  format_brief(conflicts.path_length) + " " + symbol + " of path",
              {{"points", static_cast<double>(conflicts.longest_group_points)},
               {"length", conflicts.longest_group},
               {"path_length", conflicts.path_length}});
  if (!conflicts.longest_group_height_from) return {std::move(message)};
  const double from = *conflicts.longest_group_height_from, to = *conflicts.longest_group_height_to;
  message.text += ", " + heights_text(from, to, symbol) + " the lowest point of the model";
  message.numbers.push_back({"height_from", from});
  message.numbers.push_back({"height_to", to});
  if (conflicts.longest_group_is == GroupPlace::kGround) {
    if (to > 0) {
      message.text += ", mostly below " + format_brief(ground_height(unit)) + " " + symbol;
    }
    message.text += ", as the ground is under wheels";
    message.numbers.push_back({"ground", 1});
  } else if (conflicts.longest_group_is == GroupPlace::kInside) {
    message.text +=
        ", and within it on all sides, as the vehicle does that carried the scanner, or a cable "
        "along the path";
    message.numbers.push_back({"inside", 1});
  }
  return {std::move(message)};
}

}  // namespace clearway
