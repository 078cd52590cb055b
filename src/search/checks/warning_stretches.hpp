#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/messages/messages.hpp"
#include "search/checks/facts/path_looks.hpp"
#include "search/checks/question.hpp"

namespace clearway {

/// Stretches of the path as a warning describes them: the longest one with its place, the others
/// with their number and length.
struct WarningStretches {
  /// runs: at least one.
  WarningStretches(const Question& question, const PathLooks& looks,
                   const std::vector<LookRun>& runs);

  LookRun longest;
  /// For example "between pose 120 and pose 180 (12 m to 18 m along the path)".
  std::string where;
  /// For example ". The same holds for 2 other stretches, 34 m long in all"; empty where there are
  /// no others.
  std::string others;
  /// The place of the longest stretch, number and length of all, and their share of the path.
  std::vector<std::pair<std::string, double>> numbers;
  /// All stretches, by the numbers of the poses that users know.
  std::vector<PoseRange> stretches;
};

/// A number of a message by its name; nothing where the message has none of that name.
std::optional<double> number_in(const Message& message, std::string_view name);

/// Whether a warning is about a stretch of the path and not about the whole path.
bool is_of_stretch(const Message& message);

/// The length of the stretch that a warning names, by chainage; 0 where it names none.
double length_of_stretch(const Message& message);

}  // namespace clearway
