#pragma once

#include "clearway/answer.hpp"

namespace clearway::tool {

/// The exit codes of the program. `run`, `merge`, `compare`, `verify` and `campaign run` set
/// kDiffers themselves; `run`, `merge` and `campaign run` also set kUndecided.
enum ExitCode {
  kDone = 0,
  kDiffers = 1,
  kWrongUsage = 2,
  kBadInput = 3,
  kResource = 4,
  kInterrupted = 5,
  kUndecided = 6
};

/// The exit code of a verdict under --fail-on-collision. One part alone never says that nothing
/// collides.
inline int exit_code_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kClear:
      return kDone;
    case Verdict::kConflict:
      return kDiffers;
    case Verdict::kUndecided:
    case Verdict::kUnknown:
      break;
  }
  return kUndecided;
}

/// The more urgent of two tasks' exit codes. Failures come before conflicts, and these before
/// undecided ones: 5, 4, 3, 2, 1, 6, 0.
inline int more_urgent(int a, int b) {
  const auto rank = [](int code) { return code == kUndecided ? 1 : code == kDone ? 0 : code + 1; };
  return rank(a) < rank(b) ? b : a;
}

}  // namespace clearway::tool
