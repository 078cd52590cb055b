#pragma once

#include <cstdint>
#include <vector>

#include "core/util/message_log.hpp"
#include "search/checks/facts/path_cover.hpp"
#include "search/checks/facts/path_looks.hpp"
#include "search/checks/question.hpp"

/// Each looks for one kind of misunderstanding and warns of it, at most once a code. None changes
/// the answer. Thresholds and reasons: docs/design/inputs.md, "Checks of a query".
namespace clearway {

/// The path passes where nothing was scanned: "out-of-reach", "leaves-scan".
void check_reach(const Question& question, const PathCover& cover, MessageLog& log);

/// The model never comes down to the ground, or not on a stretch of the path: "floats". Returns
/// whether it warned of the whole path.
bool check_height(const Question& question, const PathLooks& looks, MessageLog& log);

/// What was scanned below and beside the model, on the whole path or on stretches of it:
/// "nothing-below", "nothing-beside", "one-side". `floats`: the model is known to be above the
/// ground.
void check_surroundings(const Question& question, const PathLooks& looks, bool floats,
                        MessageLog& log);

/// Unit and frame of the model: "model-size", "model-origin", "model-is-environment".
void check_model(const Question& question, MessageLog& log);

/// The model stands over something at the first pose: "inside-model". Reads the points there.
/// asked: the question's query, before its surface was sampled; what its solids contain collides.
void check_inside(const Question& question, const Query& asked, MessageLog& log);

/// Things can pass through the model: "open-model".
void check_open_model(const Question& question, MessageLog& log);

/// Holes between the model's points: "model-spacing".
void check_model_spacing(const Question& question, MessageLog& log);

/// The radius against model and scan: "radius-size", "fine-radius", "coarse-scan".
void check_radius(const Question& question, MessageLog& log);

/// What lies between two poses: "large-steps", and "trajectory-jump" for steps of which it does not
/// warn. Of a vehicle's bodies, a jump of the path that they follow is told of once.
class StepChecks {
 public:
  StepChecks() = default;
  /// path: of a vehicle, whose bodies are checked next. Its jumps are left to check_path.
  explicit StepChecks(const Question& path);

  void check(const Question& question, MessageLog& log);
  /// After all bodies: the jumps of the path where "large-steps" has not warned of any of them.
  void check_path(const Question& path, MessageLog& log) const;

 private:
  std::vector<std::uint32_t> path_jumps_, told_;  ///< poses from which a step starts, ascending
};

/// The way that the model goes, against its own axes: "tilted", "rotations", "sideways",
/// "leans", "flat-model", "scaled-poses", "tiny-path".
void check_heading(const Question& question, MessageLog& log);

}  // namespace clearway
