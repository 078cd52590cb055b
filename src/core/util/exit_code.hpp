#pragma once

namespace clearway {

/// The exit codes of the programs. `run`, `merge`, `compare`, `verify` and `campaign run` set
/// kDiffers themselves; `run`, `merge`, `compare` and `campaign run` also set kUndecided.
enum ExitCode {
  kDone = 0,
  kDiffers = 1,
  kWrongUsage = 2,
  kBadInput = 3,
  kResource = 4,
  kInterrupted = 5,
  kUndecided = 6
};

}  // namespace clearway
