#pragma once

#include <signal.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "io/files/pending_file.hpp"
#include "io/result/journal.hpp"
#include "support/catch.hpp"
#include "tools/cli/support/process.hpp"
#include "tools/cli/support/program.hpp"

namespace clearway::test {

/// A hall that the grid engine searches for a second; made once.
class SlowHall {
 public:
  static const SlowHall& get() {
    static const SlowHall hall;
    return hall;
  }
  std::string path(const std::string& name) const { return quoted(folder_ / name); }

 private:
  SlowHall() {
    const std::string folder = quoted(folder_ / "");
    if (run_program(folder_,
                    "scene hall --points 500000 --model-points 10000 --poses 1500 -o " + folder)
                .exit_code != 0 ||
        run_program(folder_, "convert " + path("environment.las") + " --cell-points 500 -o " +
                                 path("site.h5"))
                .exit_code != 0) {
      throw std::runtime_error("no hall");
    }
  }

  ScratchFolder folder_;
};

/// A run in the slow hall, with its output and its journal.
struct Work {
  std::string command(const std::string& options, const std::string& radius = "0.1",
                      const std::string& engine = "grid") const {
    return "run --env " + hall.path("site.h5") + " --model " + hall.path("model.ply") +
           " --trajectory " + hall.path("trajectory.txt") + " --engine " + engine +
           " --device cpu --radius " + radius + " -o " + quoted(output) + " " + options;
  }
  Outcome run(const std::string& options, const std::string& radius = "0.1",
              const std::string& engine = "grid") const {
    return run_program(folder, command(options, radius, engine));
  }
  /// Runs with a file of these bytes in place of one of the hall's.
  Outcome run_with(const std::string& name, const std::string& bytes) const {
    put_bytes(folder / "other.txt", bytes);
    std::string changed = command("--resume");
    const std::string before = hall.path(name);
    changed.replace(changed.find(before), before.size(), quoted(folder / "other.txt"));
    return run_program(folder, changed);
  }
  /// Starts a run, lets it finish a few cells and sends it a signal.
  void start_and(int signal, const std::string& options = "") const {
    Process process(command(options), folder / "log.txt");
    wait_for_records(process, 20);
    process.send(signal);
    REQUIRE(process.wait() == (signal == SIGKILL ? -SIGKILL : 5));
  }
  void wait_for_records(Process& process, std::uint64_t records) const {
    while (!std::filesystem::exists(journal) || JournalReader(journal).records() < records) {
      REQUIRE(process.running());
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(output.parent_path())) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  const SlowHall& hall = SlowHall::get();
  ScratchFolder folder;
  std::filesystem::path output =
      (std::filesystem::create_directory(folder / "out"), folder / "out" / "out.h5");
  std::filesystem::path journal = journal_of(output);
};

using Names = std::vector<std::string>;

}  // namespace clearway::test
