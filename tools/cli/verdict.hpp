#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "clearway/merge.hpp"
#include "clearway/pose.hpp"
#include "clearway/search.hpp"
#include "clearway/trajectory.hpp"
#include "io/result/result.hpp"

namespace clearway::tool {

/// A place of the answer: an environment point, and the pose at which it counts.
struct AnswerPlace {
  std::uint64_t source = 0;
  std::uint32_t pose = 0;
  std::optional<double> chainage{};  ///< of the pose, in the unit of the path
  std::optional<Vec3> xyz{};
  std::optional<double> distance{};
  std::optional<std::string> body{};  ///< its name, where there are several
};

/// The answer of a run in short.
struct Verdict {
  std::uint64_t colliding_points = 0;
  QueryParameters query{};
  IgnoredPointCounts ignored{};
  std::optional<Shard> shard{};  ///< where it is the answer of one part: never clear
  bool float_precision = false;
  std::optional<AnswerPlace> first;            ///< with first poses: at the smallest, least source
  std::optional<AnswerPlace> least_clearance;  ///< of equals the least source
  std::optional<AnswerPlace> least_profile;    ///< of equals the first pose
  bool has_depths = false;  ///< of a model with solids: distances below 0 are depths
  std::optional<std::uint64_t> points_inside{};  ///< then, with clearances

  bool is_conflict() const { return colliding_points > 0; }
  bool is_clear() const { return !is_conflict() && !shard; }
  /// The least distance that is known.
  const std::optional<AnswerPlace>& nearest() const {
    const bool names_body = least_clearance && least_clearance->body;  // a profile names none
    if (names_body && (!least_profile || *least_clearance->distance <= *least_profile->distance)) {
      return least_clearance;
    }
    return least_profile ? least_profile : least_clearance;
  }
};

/// Of a result that was just written.
Verdict verdict_of(const SearchReport& report, const Query& query, const SearchOptions& options);

/// Of what was just merged.
Verdict verdict_of(const MergeReport& report, bool float_precision);

/// Reads the tables that the result has, whoever wrote it. poses: those of the search; none
/// where they are not at hand. Throws as ResultReader does.
Verdict verdict_of(const ResultReader& result, const std::vector<Pose>& poses);

/// "3 of 2,001 environment points collide"
std::string found_text(std::uint64_t colliding_points, std::uint64_t environment_points);

/// ", but see the 2 warnings above": no all-clear where something was warned of. Empty without.
std::string caveat_of(std::size_t warnings);

/// One sentence, without what `caveat` adds before its end. unit: of lengths, "m".
std::string verdict_text(const Verdict& verdict, const PoseLabels& labels, const std::string& unit,
                         const std::string& caveat);

/// The greatest depth inside the model, metres; 0 where nothing is inside. None where that is not
/// known.
std::optional<double> greatest_depth(const Verdict& verdict);

/// Adds the keys verdict ("unknown" of a part without colliding points), shard, ignored,
/// points_inside, greatest_depth, least_clearance, least_profile and first_place.
void add_verdict(const Verdict& verdict, const PoseLabels& labels, nlohmann::ordered_json& out);

}  // namespace clearway::tool
