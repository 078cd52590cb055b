#pragma once

#include <filesystem>
#include <string>

#include "tools/cli/support/program.hpp"

namespace clearway::test {

/// A hall and its store, made once for all tests of this program.
class Hall {
 public:
  /// A hall of 30,000 points with a model of 300 points and 150 poses.
  static const Hall& get();
  /// A hall of 12,000 points with a model of 200 points and 100 poses, for brute force or for
  /// hundreds of runs.
  static const Hall& small();

  std::string operator/(const std::string& name) const { return quoted(folder_ / name); }
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }

 private:
  explicit Hall(const std::string& size);

  ScratchFolder folder_;
};

/// A folder for what a test writes.
struct Work {
  Outcome run(const std::string& arguments, const std::filesystem::path& pipe = {}) const;
  /// Runs a search in the hall, whose result is `output` in this folder.
  Outcome run_hall(const std::string& environment, const std::string& output,
                   const std::string& options = "") const;
  std::string path(const std::string& name) const { return quoted(folder / name); }
  std::string bytes(const std::string& name) const { return bytes_of(folder / name); }

  const Hall& hall = Hall::get();
  ScratchFolder folder = {};
};

void check_refused(const Outcome& outcome, int exit_code, const std::string& message);

}  // namespace clearway::test
