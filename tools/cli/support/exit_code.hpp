#pragma once

namespace clearway::tool {

/// Of the program; `run`, `compare` and `verify` set kDiffers themselves.
enum ExitCode {
  kDone = 0,
  kDiffers = 1,
  kWrongUsage = 2,
  kBadInput = 3,
  kResource = 4,
  kInterrupted = 5
};

}  // namespace clearway::tool
