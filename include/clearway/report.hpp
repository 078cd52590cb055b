#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/body.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/model.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/result.hpp"
#include "clearway/store.hpp"
#include "clearway/trajectory.hpp"

namespace clearway {

struct ReportOptions {
  std::string title = {};  ///< empty: made of the names below
  /// For the head of the page, as they are; empty ones are left out.
  std::string project = {}, client = {}, author = {};
  std::string date = {};  ///< as it is to stand on the page; nothing else in it depends on the time
  /// Names of the files for people; empty ones are left out.
  std::string result_name = {}, environment_name = {}, model_name = {}, trajectory_name = {};
  /// What was left out of the model's file: points whose z is below it, and how many. For the page
  /// to say; `model` is without them.
  std::optional<double> model_above = {};
  std::uint64_t model_left_out = 0;
  /// Metres, ascending, one to three: distances below which a point counts as hit, near or watch.
  /// The last is at least the radius, and none above it is beyond the clearance asked for. Empty:
  /// the radius, and the clearance where that is larger.
  std::vector<double> classes = {};
  std::uint64_t max_points = 1'000'000;  ///< environment points on the page at most
  /// How conflicts are found; memory, threads, progress and stop flag hold for all of the report.
  /// Its bodies do not count, those below do.
  ConflictOptions conflicts = {};
  PoseLabels labels = {};  ///< of the poses, where the trajectory has them
  /// Warnings for the page to show, such as those of reading model and trajectory. What the search
  /// warned of need not be among them: it is found again from store, model and poses.
  std::vector<Message> warnings = {};
  bool overwrite = false;
  /// Of a vehicle's result: its bodies; then the model is empty.
  std::vector<Body> bodies = {};
};

struct ReportSummary {
  bool clear = true;  ///< the verdict is Verdict::kClear
  Verdict verdict = Verdict::kClear;
  std::uint64_t bytes = 0;  ///< of the page
  Conflicts conflicts;      ///< empty where the result has no first poses
  /// One JSON object: what the page says, without its points.
  std::string facts;
};

/// Writes one HTML file that needs nothing else: verdict, profile, plan, conflicts, 3-D view. model
/// and poses: those of the search. Throws InputError where model, poses or store are not those of
/// the result, or one is damaged; UsageError for classes that the result cannot tell apart and for
/// an existing output; ResourceError; Interrupted when asked to stop.
ReportSummary write_report(const Result& result, const Store& store, const Model& model,
                           const std::vector<Pose>& poses, const std::filesystem::path& output,
                           const ReportOptions& options = {});

}  // namespace clearway
