#pragma once

namespace CLI {
class App;
}

/// Each function adds one subcommand: its options, and the callback that runs it. A callback sets
/// `exit_code` where success is not 0 (check, run, merge, compare, verify, campaign run) and throws
/// otherwise.
namespace clearway::tool {

void add_check(CLI::App& program, int& exit_code);
void add_convert(CLI::App& program);
void add_run(CLI::App& program, int& exit_code);
void add_merge(CLI::App& program, int& exit_code);
void add_export(CLI::App& program);
void add_conflicts(CLI::App& program, int& exit_code);
void add_stations(CLI::App& program);
void add_shift(CLI::App& program);
void add_compare(CLI::App& program, int& exit_code);
void add_info(CLI::App& program);
void add_verify(CLI::App& program, int& exit_code);
void add_model(CLI::App& program);
void add_report(CLI::App& program);
void add_scene(CLI::App& program);
void add_section(CLI::App& program, int& exit_code);
void add_trajectory(CLI::App& program);
void add_campaign(CLI::App& program, int& exit_code);

}  // namespace clearway::tool
