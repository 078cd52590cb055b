#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/messages/messages.hpp"
#include "search/checks/facts/path_facts.hpp"
#include "search/checks/facts/path_looks.hpp"
#include "search/checks/question.hpp"

/// Checks of a query. Each looks for one kind of misunderstanding and warns of it, at most once for
/// each code, and of one side once for each side. No check changes the answer. Thresholds and
/// reasons: docs/design/inputs.md, "Checks of a query".
namespace clearway {

/// Warns where the path passes where nothing was scanned: "out-of-reach", "leaves-scan".
void check_reach(const Question& question, const PathCover& cover, MessageLog& log);

/// Warns where the whole model, also what is left out of the search, reaches below the ground at
/// most places of the path: "below-ground". Returns whether it warned.
bool check_depth(const Question& question, const PathLooks& looks, MessageLog& log);

/// Warns where the model stays above the ground on the whole path or on a stretch of it: "floats".
/// Returns whether it warned of the whole path.
bool check_height(const Question& question, const PathLooks& looks, MessageLog& log);

/// Warns of stretches without ground below or inside a model that check_depth() warned of:
/// "nothing-below".
void check_holes(const Question& question, const PathLooks& looks, MessageLog& log);

/// Warns where nothing was scanned below or beside the model, on the whole path or on stretches of
/// it: "nothing-below", "nothing-beside", "one-side". floats: whether the model is known to be
/// above the ground.
void check_surroundings(const Question& question, const PathLooks& looks, bool floats,
                        MessageLog& log);

/// Warns of a wrong unit or frame of the model: "model-unit", "model-size", "model-origin",
/// "model-is-environment", "scaled-poses", "mirrored-poses", "single-precision".
void check_model(const Question& question, MessageLog& log);

/// Warns where the model stands over something at the first pose: "inside-model". Reads the points
/// there; those in the model's solids collide and are not counted.
void check_inside(const Question& question, MessageLog& log);

/// Warns where things can pass through the model: "open-model".
void check_open_model(const Question& question, MessageLog& log);

/// Warns of holes between the model's points: "model-spacing".
void check_model_spacing(const Question& question, MessageLog& log);

/// Warns of an error budget whose numbers are hardly meant so: "few-sigmas", "small-error-angle".
void check_errors(const QueryParameters& query, MessageLog& log);

/// Compares the radius with model and scan: "radius-size", "coarse-digits" or
/// "fine-radius", "coarse-scan".
void check_radius(const Question& question, MessageLog& log);

/// Warns of what may lie between two poses: "large-steps", and "trajectory-jump" for steps that
/// "large-steps" does not warn of. A jump of the path that the bodies of a vehicle follow is
/// reported once, not for each body.
class StepChecks {
 public:
  StepChecks() = default;
  /// path: the path of a vehicle, whose bodies are checked next. Jumps of the path are left to
  /// check_path().
  explicit StepChecks(const Question& path);

  void check(const Question& question, MessageLog& log);
  /// Called after all bodies: warns of jumps of the path that "large-steps" has not warned of.
  void check_path(const Question& path, MessageLog& log) const;

 private:
  /// Poses from which a step starts, ascending.
  std::vector<std::uint32_t> path_jumps_, warned_;
};

/// Warns where the positions of the path have lost digits that matter beside the radius:
/// "single-precision", "lost-digits".
void check_path_digits(const Question& question, MessageLog& log);

/// Compares the motion with the model's own axes: "tilted", "rotations", "leans", "sideways",
/// "flat-model", "drives-backwards", "tiny-path". of_inputs: the messages of
/// reading the trajectory; where one names a mistake of the rotations, there is no second warning
/// of it.
void check_heading(const Question& question, std::span<const Message> of_inputs, MessageLog& log);

}  // namespace clearway
