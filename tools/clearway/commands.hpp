#pragma once

#include <CLI/CLI.hpp>

/// One function a subcommand: adds its options to `program` and sets the callback that runs it. A
/// callback sets `exit_code` where success is not 0 (compare, verify) and throws otherwise.
namespace clearway::tool {

void add_scene(CLI::App& program);

}  // namespace clearway::tool
