#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/query.hpp"

namespace CLI {
class App;
}

namespace clearway {
class ResultReader;
}

namespace clearway::tool {

/// A result that a command reads, and the trajectory that the command takes for it; empty where it
/// takes none.
struct ReadResult {
  std::filesystem::path path, trajectory;
};

/// The options of `clearway run` for these parameters, each after a blank: all that are not the
/// default.
std::string query_words(const QueryParameters& query);

/// The command line of `clearway run` that asks the question of a result again, and also for what
/// `missing` says: first poses, clearances or a profile. What the result does not hold comes from
/// the options of `command` as they were given, or is a word in capitals. Empty where no such run
/// exists, because there are no clearances between poses.
std::string run_again(const ResultReader& result, const CLI::App& command,
                      const std::filesystem::path& trajectory, Remedy missing);

/// Does `work`, the work of `command`. Where it throws because a result lacks what another run
/// would give, that run's command line is added to the message.
void advising_to_run_again(const CLI::App& command, const std::vector<ReadResult>& results,
                           const std::function<void()>& work);

}  // namespace clearway::tool
