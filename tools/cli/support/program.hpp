#pragma once

namespace CLI {
class App;
}

namespace clearway::tool {

struct ProgramText {
  const char* name;
  const char* description;
};

/// A function that adds the subcommands, whose callbacks set `exit_code` where success is not 0.
using AddCommands = void (*)(CLI::App& program, int& exit_code);

/// Parses the command line and runs the subcommand. Errors go to standard error. Returns an exit
/// code of cli/support/exit_code.hpp.
int run_program(const ProgramText& text, int argc, char** argv, AddCommands add_commands);

}  // namespace clearway::tool
