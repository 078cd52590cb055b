#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/body.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/follow.hpp"
#include "clearway/ledger.hpp"
#include "clearway/model.hpp"
#include "clearway/outline.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/result.hpp"
#include "clearway/section.hpp"
#include "clearway/shift.hpp"
#include "clearway/store.hpp"
#include "clearway/trajectory.hpp"

namespace clearway {

/// The texts in the head of a page, which are shown as they are. Empty ones are left out.
struct PageTexts {
  std::string title = {};  ///< if empty, made of the names of the files
  std::string project = {}, client = {}, author = {};
  std::string date = {};  ///< nothing else on the page depends on the time
};

struct ReportOptions : PageTexts {
  /// Names of the files for the reader; empty ones are left out.
  std::string result_name = {}, environment_name = {}, model_name = {}, trajectory_name = {};
  /// Distances in metres, ascending, one to three, below which a point counts as hit, near or
  /// watch. The last is at least the radius, and none above it exceeds the clearance asked for.
  /// Empty: the radius, and the clearance if that is larger.
  std::vector<double> classes = {};
  std::uint64_t max_points = 1'000'000;  ///< greatest number of environment points on the page
  /// How conflicts are found; its memory, threads, progress and stop flag apply to the whole
  /// report. Its bodies are not used: `bodies` below are.
  ConflictOptions conflicts = {};
  /// Times, names and stations of the poses, if the trajectory has them. Its stations take the
  /// place of those of `conflicts`.
  PoseLabels labels = {};
  /// Length of a stretch of the table of stations, metres; 0: 5, or the next of 10, 20, 50, 100 and
  /// so on of which there are at most 200.
  double every = 0;
  /// Warnings for the page to show besides those that the result keeps, such as those of reading
  /// model and trajectory.
  std::vector<Message> warnings = {};
  bool overwrite = false;
  /// Shifts that free the path and its conflicts, by find_shifts() for conflicts that were found
  /// with the options of `conflicts`; the page shows them.
  std::optional<ShiftTable> shifts = {};
  /// What a ledger says of the conflicts, by apply_ledger() for conflicts that were found with the
  /// options of `conflicts`; the page shows it.
  std::optional<Ledger> ledger = {};
  std::string ledger_name = {};  ///< name of its table; if empty, it is left out
  /// Bodies of the search, for the result of a vehicle; then the model is empty.
  std::vector<Body> bodies = {};
  /// How each of these bodies follows the path, for the page to say its axles and pivots; or empty.
  std::vector<BodyMount> mounts = {};
  /// A section of the same path through the same environment, which the page shows; or null. It
  /// must outlive the call.
  const Section* section = nullptr;
  std::string section_name = {};  ///< name of its file; if empty, it is left out
};

struct ReportSummary {
  bool clear = true;  ///< whether the verdict is Verdict::kClear
  Verdict verdict = Verdict::kClear;
  std::uint64_t bytes = 0;  ///< size of the page
  Conflicts conflicts;      ///< empty if the result has no first poses
  /// One JSON object with what the page says, without its points.
  std::string facts;
};

/// Writes the report as one self-contained HTML file: verdict, profile, plan, conflicts, 3-D view.
/// model and poses are those of the search. Throws InputError where model, poses or store are not
/// those of the result, or one is damaged; UsageError for classes that the result cannot
/// distinguish and for an existing output; ResourceError; Interrupted when asked to stop.
ReportSummary write_report(const Result& result, const Store& store, const Model& model,
                           const std::vector<Pose>& poses, const std::filesystem::path& output,
                           const ReportOptions& options = {});

/// An obstacle that is known by a name, such as a conflict.
struct NamedObstacle {
  std::string name;
  Box box{};  ///< around its points, in the environment's unit
};

/// Reads the conflicts of a CSV file that `clearway conflicts` wrote. They are called "conflict 1"
/// and so on, or as a column `name` says that was added by hand. Throws InputError, which names the
/// line.
std::vector<NamedObstacle> read_obstacles(const std::filesystem::path& path);

/// What is drawn and said of a section.
struct SectionPicture {
  /// The outline of a load, whose passing is judged and drawn, or empty.
  std::vector<OutlinePoint> outline = {};
  /// Outlines by stretches of the path, in place of one outline; or without rows. station: of each
  /// pose of the path, for a table by stations.
  OutlineTable table = {};
  std::vector<double> station = {};
  /// The distance that the load keeps; none: that for which the section was found
  std::optional<double> margin = {};
  SectionHeights heights = {};  ///< the bands of height whose widths are shown
  /// Store and path of the section, both or none, which must outlive the call. With them the points
  /// that stop the load are found.
  const Store* store = nullptr;
  const std::vector<Pose>* path = nullptr;
  std::vector<NamedObstacle> obstacles = {};  ///< names for these points; needs store and path
  /// Names of the files for the reader; empty ones are left out.
  std::string section_name = {}, outline_name = {}, environment_name = {}, trajectory_name = {};
};

struct SectionPageOptions : SectionPicture, PageTexts {
  std::vector<Message> warnings = {};  ///< shown besides those of the section
  bool overwrite = false;
};

struct SectionPageSummary {
  std::optional<SectionCheck> check = {};  ///< none without an outline
  std::string sentence = {};               ///< the answer in a sentence
  std::uint64_t bytes = 0;                 ///< size of the page
  std::string facts = {};                  ///< one JSON object with what the page says
};

/// Writes a page about a section as one self-contained HTML file: the answer, the picture of the
/// cross-section, the widths along the path, and the places that stop a load. Throws InputError
/// where store or path are not those of the section, where obstacles lie outside of the store, or
/// where the store is damaged; UsageError as Section::check() and export_section() do, for
/// obstacles without store and path, and for an existing output; ResourceError.
SectionPageSummary write_section_page(const Section& section, const std::filesystem::path& output,
                                      const SectionPageOptions& options = {});

/// Writes the picture of a section, looking forward, as an SVG file. Throws as
/// write_section_page() does.
void write_section_picture(const Section& section, const std::filesystem::path& output,
                           const SectionPicture& picture = {}, bool overwrite = false);

}  // namespace clearway
