#pragma once

#include <catch2/catch.hpp>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "tools/cli/program.hpp"

namespace clearway::test {

/// A small hall, made once for all tests of this program.
class Hall {
 public:
  static const Hall& get() {
    static const Hall hall;
    return hall;
  }
  std::string operator/(const std::string& name) const { return quoted(folder_ / name); }
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }

 private:
  Hall() {
    const Outcome made = run_program(
        folder_, "scene hall --points 30000 --model-points 300 --poses 150 -o " + *this / "");
    const Outcome converted =
        run_program(folder_, "convert " + *this / "environment.las" + " -o " + *this / "site.h5");
    if (made.exit_code != 0 || converted.exit_code != 0) throw std::runtime_error("no hall");
  }

  ScratchFolder folder_;
};

/// A folder for what a test writes.
struct Work {
  Outcome run(const std::string& arguments, const std::filesystem::path& pipe = {}) const {
    return run_program(folder, arguments, pipe);
  }
  /// The result of a run in the hall, as `output` here.
  Outcome run_hall(const std::string& environment, const std::string& output,
                   const std::string& options = "") const {
    return run("run --env " + environment + " --model " + hall / "model.ply" + " --trajectory " +
               hall / "trajectory.txt" + " --radius 0.1 -o " + path(output) + " " + options);
  }
  std::string path(const std::string& name) const { return quoted(folder / name); }
  std::string bytes(const std::string& name) const { return bytes_of(folder / name); }

  const Hall& hall = Hall::get();
  ScratchFolder folder;
};

inline void check_refused(const Outcome& outcome, int exit_code, const std::string& message) {
  CHECK(outcome.exit_code == exit_code);
  CHECK(outcome.out.empty());
  CHECK_THAT(outcome.err, Catch::Contains(message));
}

}  // namespace clearway::test
