#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/trajectory.hpp"
#include "clearway/unseen.hpp"

/// What the command line and pages say of an answer.
namespace clearway {

/// The labels of a path's poses, and how far along it they are. Empty where the path is not at hand
/// or has no such labels.
struct PathWords {
  PoseLabels labels = {};
  std::vector<double> chainage = {};
};

/// An answer in clauses, each of them empty where there is nothing to say. A sentence begins with a
/// clause, and others follow it after "; ".
struct AnswerWords {
  std::string verdict = {};  ///< "clear with warnings", with what it is because of
  std::string ignored = {};  ///< "12 points ignored (class 2), 3 of which would collide"
  std::string floor =
      {};  ///< "1,190 points within the radius below 0.25 m of the vehicle not judged"
  std::string finding =
      {};  ///< "no environment point is closer than 0.1 m to the model on its way"
  std::string classes = {};  ///< of what collides or is near, where they say something
  std::string first = {};    ///< the first place that collides
  std::string seen = {};     ///< "not scanned on 3.2 of 68.0 m: ..."; of no part of a run
  std::string nearest = {};  ///< the least distance, or that none is within what was asked for
  std::string spacing = {};  ///< of a mesh that was searched as points, unless it is in conflict
  std::string searched =
      {};                  ///< on how much of the path a vehicle was searched, unless on all of it
  std::string doubt = {};  ///< on how much of the path nothing could be found
};

/// unit: the symbol of lengths, such as "m".
AnswerWords answer_words(const Answer& answer, const PathWords& path, const std::string& unit);

/// A clause as a sentence: with a capital letter and a full stop. Empty for an empty one.
std::string sentence_of(std::string clause);

/// Whether the place's coordinates are known; only old files lack them.
bool has_xyz(const FoundPlace& place);

/// The name of the body that is nearest at a place of an answer; empty for one model, and for a
/// profile, which does not say which body is nearest.
std::string body_of(const Answer& answer, const std::optional<FoundPlace>& place);

/// The verdict in one sentence, with `caveat` before its end. names_nearest: whether a conflict is
/// named by its nearest place, which need not be the worst.
std::string verdict_text(const Answer& answer, const PathWords& path, const std::string& unit,
                         const std::string& caveat, bool names_nearest = true);

/// Sentences about the places that were not scanned, each with a blank before it: which are behind
/// a conflict, and which is probably the ground. Empty where there is nothing to say.
std::string unseen_text(const UnseenGroups& unseen, const Answer& answer, const std::string& unit);

}  // namespace clearway
