#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "clearway/progress.hpp"

namespace CLI {
class App;
}

namespace clearway::tool {

// The files in the folder of a check.
inline constexpr const char* kStoreName = "site.h5";
inline constexpr const char* kPathName = "path.txt";
inline constexpr const char* kResultName = "result.h5";
inline constexpr const char* kConflictsName = "conflicts.csv";
inline constexpr const char* kStationsName = "stations.csv";
inline constexpr const char* kReportName = "report.html";

/// The options of `clearway check` that are not those of a step.
struct CheckCommand {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path folder;
  bool near = false;  ///< whether the store holds only what the question can reach
  bool force = false, fail_on_collision = false, json = false, open = false;
  const CLI::App* command = nullptr;  ///< the command that has these options
};

using Words = std::vector<std::string>;  ///< of a command line

struct StepOptions;

/// Adds the options that check passes on to its steps.
void offer_options_of_steps(CLI::App& check);

/// The command lines of the steps of a check, without the program's name. They are what is done and
/// what is shown, so that a user who repeats one gets the same file.
class CheckPlan {
 public:
  /// The options outlive this object. Throws UsageError for a store among scans.
  explicit CheckPlan(const CheckCommand& options);

  /// Whether the input is a store already, so that nothing is converted.
  bool has_store() const { return has_store_; }
  std::filesystem::path environment() const;
  /// The inputs without the files of the vehicle.
  const std::vector<std::filesystem::path>& scans() const { return scans_; }
  /// What there is to say of the inputs that are not taken as scans, because they are the vehicle.
  const std::vector<Message>& remarks() const { return remarks_; }
  std::filesystem::path file(const char* name) const { return options_.folder / name; }

  /// replacing: in the place of what is there and does not agree. Otherwise the step goes on with
  /// what is there.
  Words convert(bool replacing) const;
  /// The path with more poses, so that the model moves no farther than the radius from one to the
  /// next; no words where the question needs none.
  Words resample() const;
  /// From here on the conversion keeps only the points within `metres` of the path.
  void keep_near(double metres) { near_metres_ = metres; }
  /// From here on the steps take the output of resample() as the path.
  void take_denser_path() { has_denser_path_ = true; }

  Words run(bool replacing) const;
  Words conflicts() const;
  Words stations() const;
  /// date: for the page, where the user names none; empty: none.
  Words report(const std::string& date) const;

  /// Whether the conflicts are compared with a ledger, which may have changed since the last time.
  bool has_ledger() const;

  /// A sentence on the distances that the user did not ask for but that are found; empty where
  /// there are none.
  std::string about_distances() const;

 private:
  std::vector<std::filesystem::path> models() const;
  void leave_out_models();
  bool is_given(const char* name) const;
  std::string value_of(const char* name) const;
  bool has_budget() const;
  Words distances() const;
  template <typename Command>
  Words given(const StepOptions& how) const;
  Words corridor() const;

  const CheckCommand& options_;
  const CLI::App& check_;
  std::vector<std::filesystem::path> scans_;  ///< files, and folders that hold no model
  std::vector<Message> remarks_;
  bool has_store_;
  double near_metres_ = 0;  ///< 0: the conversion keeps all points
  bool has_denser_path_ = false;
};

}  // namespace clearway::tool
