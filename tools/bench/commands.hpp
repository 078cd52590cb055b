#pragma once

namespace CLI {
class App;
}

/// Each adds subcommands to `program` and sets the callbacks that run them.
namespace clearway::bench {

/// One subcommand an experiment (docs/design/evaluation.md). `exit_code` becomes kDiffers where
/// results that must be equal are not.
void add_experiments(CLI::App& program, int& exit_code);

/// The stages of a run on a GPU alone.
void add_stages(CLI::App& program);

/// The kdtree engine against nanoflann; where the build found that.
void add_peers(CLI::App& program);

}  // namespace clearway::bench
