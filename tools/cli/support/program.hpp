#pragma once

#include <string>

#include "clearway/answer.hpp"
#include "clearway/error.hpp"
#include "clearway/progress.hpp"
#include "core/util/exit_code.hpp"

namespace CLI {
class App;
}

namespace clearway::tool {

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

/// Advice on an error in terms of the command line, such as "; --force overwrites it". Empty where
/// the error says all.
std::string advice_on(const Error& error);

/// Advice on a note or a warning, as a sentence to append: ". --between-poses ...". Empty where the
/// message says all.
std::string advice_on(const Message& message);

struct ProgramText {
  const char* name;
  const char* description;
  const char* first_steps = "";  ///< printed by a call without arguments; empty: the help is
};

/// A function that adds the subcommands, whose callbacks set `exit_code` where success is not 0.
using AddCommands = void (*)(CLI::App& program, int& exit_code);

/// Parses the command line and runs the subcommand. Errors go to standard error. Returns an
/// ExitCode.
int run_program(const ProgramText& text, int argc, char** argv, AddCommands add_commands);

}  // namespace clearway::tool
