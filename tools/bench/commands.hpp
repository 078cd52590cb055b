#pragma once

namespace CLI {
class App;
}

/// Each function adds subcommands to `program` and sets the callbacks that run them.
namespace clearway::bench {

/// Adds one subcommand for each experiment (docs/design/evaluation.md). `exit_code` becomes
/// kDiffers where results that must be equal are not.
void add_experiments(CLI::App& program, int& exit_code);

/// Adds the command that times each stage of a run on a GPU by itself.
void add_stages(CLI::App& program);

/// Adds the command that times the questions of a session.
void add_session(CLI::App& program);

/// Adds the command that searches with engines that are set as no `clearway run` sets them.
void add_search(CLI::App& program);

}  // namespace clearway::bench
