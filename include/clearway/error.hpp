#pragma once

#include <stdexcept>
#include <string>

namespace clearway {

/// What the world does wrong. The program's exit code is chosen by type, in main alone.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Options that contradict each other or ask for what cannot be done. Exit code 2.
struct UsageError : Error {
  using Error::Error;
};

/// A malformed or unsupported input: what() names file, line or byte, and what was expected.
/// Exit code 3.
struct InputError : Error {
  using Error::Error;
};

/// I/O failure or a resource that is not there (disk full, budget too small). Exit code 4.
struct ResourceError : Error {
  using Error::Error;
};

/// Stopped on request (core/util/progress.hpp), with nothing lost that a journal holds. Exit
/// code 5.
struct Interrupted : Error {
  using Error::Error;
};

}  // namespace clearway
