#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/util/message_log.hpp"
#include "search/checks/facts/path_looks.hpp"
#include "search/checks/question.hpp"

namespace clearway {

/// Stretches of the path as a warning tells of them: the longest with its place, the others with
/// their number and length.
struct ToldStretches {
  /// `runs` is not empty.
  ToldStretches(const Question& question, const PathLooks& looks, const std::vector<LookRun>& runs);

  LookRun longest;
  /// "between pose 120 and pose 180 (12 m to 18 m along the path)"
  std::string where;
  /// ". The same holds for 2 other stretches, 34 m long in all", or nothing.
  std::string others;
  /// Place of the longest, number and length of all, and their share of the path.
  std::vector<std::pair<std::string, double>> numbers;
};

/// Whether a warning is of a stretch of the path, not of the whole path.
bool is_of_stretch(const Message& message);

/// How long the stretch is that a warning names; 0 where it names none.
double told_length(const Message& message);

}  // namespace clearway
