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

/// A folder for what a test writes. The files of the hall are in `hall` there.
struct Work : Workplace {
  explicit Work(const Hall& of = Hall::get());

  /// Runs a search in the hall, whose result is `output` in this folder.
  Outcome run_hall(const std::string& environment, const std::string& output,
                   const std::string& options = "") const;

  const Hall& hall;
};

}  // namespace clearway::test
