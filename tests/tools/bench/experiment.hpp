#pragma once

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/cli/support/program.hpp"

namespace clearway::test {

using Json = nlohmann::ordered_json;

/// Runs an experiment of the built program clearway-bench, on scenes of a few thousand points.
class Experiment {
 public:
  explicit Experiment(const std::string& name, int repetitions = 2)
      : name_(name), repetitions_(repetitions) {}

  Outcome run(const std::string& more = "") const {
    return run_program_at(CLEARWAY_BENCH_PROGRAM, folder_,
                          name_ + " --size smoke --device cpu --repetitions " +
                              std::to_string(repetitions_) + " -o " + quoted(file()) + " --work " +
                              quoted(work()) + " " + more);
  }
  std::filesystem::path work() const { return folder_ / "work"; }
  std::filesystem::path file() const { return folder_ / "figures.json"; }
  Json figures() const { return Json::parse(bytes_of(file())); }
  void write(const Json& figures) const { std::ofstream(file()) << figures.dump(); }

 private:
  std::string name_;
  int repetitions_;
  ScratchFolder folder_;
};

}  // namespace clearway::test
