#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/trajectory.hpp"
#include "io/result/result.hpp"

/// An answer in words and as JSON. What it is, the library says: see clearway/answer.hpp.
namespace clearway::tool {

/// What the poses of a path are called and how far along it they are. Empty columns where the path
/// is not at hand, or has no such labels.
struct PathWords {
  PoseLabels labels = {};
  std::vector<double> chainage = {};
};

/// "3 of 2,001 environment points collide"
std::string found_text(std::uint64_t colliding_points, std::uint64_t environment_points);

/// ", but see the 2 warnings above": no all-clear where something was warned of. Empty without.
std::string caveat_of(std::size_t warnings);

/// One sentence, without what `caveat` adds before its end. unit: of lengths, "m".
std::string verdict_text(const Answer& answer, const PathWords& path, const std::string& unit,
                         const std::string& caveat);

/// The verdict of a result that is there already, in one sentence; empty where points collide and
/// none was ignored, because what collides then says enough. Reads all tables of the result.
std::string verdict_to_repeat(const ResultReader& result, const PathWords& path,
                              const std::string& unit);

/// For commands that do not word the verdict: warns where the result's is undecided, so that nobody
/// takes an empty list for an all-clear.
void warn_of_doubts(const ResultReader& result);

/// Adds the keys verdict, reasons, margins, seen, path_length and its parts, shard, ignored,
/// points_inside, greatest_depth, least_clearance, least_profile and first_place.
void add_answer(const Answer& answer, const PathWords& path, nlohmann::ordered_json& out);

}  // namespace clearway::tool
