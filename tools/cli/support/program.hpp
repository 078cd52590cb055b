#pragma once

namespace CLI {
class App;
}

namespace clearway::tool {

struct ProgramText {
  const char* name;
  const char* description;
};

/// Adds the subcommands. Their callbacks set `exit_code` where success is not 0.
using AddCommands = void (*)(CLI::App& program, int& exit_code);

/// The whole of a main function. Errors go to standard error; the exit codes are those of
/// cli/exit_code.hpp.
int run_program(const ProgramText& text, int argc, char** argv, AddCommands add_commands);

}  // namespace clearway::tool
