#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "clearway/answer.hpp"
#include "io/result/result.hpp"
#include "report/answer_words.hpp"

/// Answers in words and as JSON. The library decides what an answer is; see clearway/answer.hpp.
namespace clearway::tool {

/// Says how many points collide: "3 of 2,001 environment points collide".
std::string found_text(std::uint64_t colliding_points, std::uint64_t environment_points);

/// A clause such as "; see the 2 warnings above", so that no verdict stands alone where there were
/// warnings. Empty without warnings.
std::string caveat_of(std::size_t warnings);

/// The verdict of an existing result, in one sentence; empty where points collide and none was
/// ignored, because the other output says enough then. Reads all tables of the result.
std::string verdict_to_repeat(const ResultReader& result, const PathWords& path,
                              const std::string& unit);

/// Repeats the warnings of the run of a result. Then warns where its verdict is undecided, or a
/// conflict is in doubt, so that nobody takes an empty list for an all-clear, or a short one for
/// all that collides. For commands that do not word the verdict.
/// prefix: text before each warning of the run, such as the name of the result.
void repeat_warnings(const ResultReader& result, const std::string& prefix = {});

/// The two margins of an error budget, metres; null without a budget.
nlohmann::ordered_json margins_json(const Answer& answer);
/// What is known of seen space; null where it was not asked for.
nlohmann::ordered_json seen_json(const Answer& answer);

/// All numbers of an error budget, as they are named in ErrorBudget.
nlohmann::ordered_json budget_json(const ErrorBudget& budget);

/// Adds the keys points_inside and greatest_depth.
void add_inside(const Answer& answer, nlohmann::ordered_json& out);

/// Adds the keys path_length, searched_length and partly_searched_length.
void add_searched(const SearchedLength& searched, nlohmann::ordered_json& out);

/// Adds an answer to a report: the keys poses, colliding_points, clearance_points, profile_poses,
/// verdict, reasons, doubts, margins, seen, path_length and its parts,
/// shard, ignored, points_inside, greatest_depth, least_clearance, least_profile,
/// first_place and depth.
void add_answer(const Answer& answer, const PathWords& path, nlohmann::ordered_json& out);

}  // namespace clearway::tool
