#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/axis.hpp"
#include "clearway/box.hpp"
#include "clearway/error_budget.hpp"
#include "clearway/ignored.hpp"
#include "clearway/progress.hpp"
#include "clearway/query.hpp"
#include "clearway/shard.hpp"
#include "clearway/unsearched.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/files/json.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/scan_dates.hpp"

namespace clearway {

class TableFile;

/// What a result answers: it depends only on the source points, the model, the trajectory and the
/// parameters (docs/design/result-format.md), so that `cmp` compares runs. Two results with equal
/// questions have equal tables.
struct ResultQuestion : QueryParameters {
  std::uint64_t environment_points = 0;
  /// Hash of the source points, the same for every file format and layout.
  std::uint64_t environment_hash = 0;
  std::uint64_t model_points = 0;
  std::uint64_t model_hash = 0;
  /// Number of triangles of a mesh, whose corners are the model's points; for several bodies, of
  /// all of them. 0 where the model is points.
  std::uint64_t model_triangles = 0;
  /// Number of parts of the model that have an inside; where there are any, distances may be below
  /// 0.
  std::uint64_t model_solids = 0;
  Box model_box{};  ///< box of the model's points
  std::uint64_t poses = 0;
  std::uint64_t trajectory_hash = 0;
  Quantisation quantisation{};
  std::string crs_wkt = {};
  /// Names of the bodies; empty unless the query has several.
  std::vector<std::string> bodies = {};
  /// The floor of each body, its own or that of the query; empty where no body has one.
  std::vector<std::optional<double>> body_floors = {};
  /// Numbers of points for ignore_classes and ignore_boxes, whose order is that of sort_ignored().
  IgnoredPointCounts ignored{};
  /// Hash of the classes of all points, which the tables have a column of; 0 where the scans have
  /// none.
  std::uint64_t classes_hash = 0;
  /// The error budget, if the query has one. It decides where /near ends.
  std::optional<ErrorBudget> budget = {};

  bool has_first_bodies() const { return first_pose && !bodies.empty(); }
  bool has_classes() const { return classes_hash != 0; }
  friend bool operator==(const ResultQuestion&, const ResultQuestion&) = default;
};

/// What a result says of its inputs beside the question, which does not depend on it.
struct ResultNotes {
  /// The spacing of the model's points in metres (Query::model_spacing), the greatest of all
  /// bodies. It shows how far the answer may be from that for the surface; the question is about
  /// the points alone.
  double model_spacing = 0;
  /// The axes of the model's file that pointed ahead and up before the model was turned
  /// (file_axes() of the query). The question is about the turned model.
  ModelAxes model_axes = {};
  std::string length_unit = {};  ///< unit of the store, as in Store::length_unit()
  /// Hash of what is known of the inputs before the search: their warnings, without the words, the
  /// days of the scans, the number of withheld points and, for seen space, where scanners stood.
  std::uint64_t inputs_hash = 0;

  friend bool operator==(const ResultNotes&, const ResultNotes&) = default;
};

/// Which part of a result a file is.
struct ResultPart {
  Shard shard;
  std::uint64_t division = 0;  ///< hash of how the cells of the store are divided among the parts
  std::uint64_t store = 0;     ///< fingerprint of the store

  friend bool operator==(const ResultPart&, const ResultPart&) = default;
};

/// What a result says beside its tables and findings.
struct ResultHeader : ResultQuestion {
  ResultNotes notes = {};
  std::optional<ResultPart> part = {};  ///< set where the file is one that merge() combines

  const ResultQuestion& question() const { return *this; }
  bool operator==(const ResultHeader&) const = delete;  // notes are no reason to differ
};

/// Whether two headers are of the same question, and of the same part of its answer.
inline bool same_answer(const ResultHeader& a, const ResultHeader& b) {
  return a.question() == b.question() && a.part == b.part;
}

/// The unit of all lengths of a result: that of the store.
LengthUnit unit_of(const ResultHeader& header);

/// Metres per unit of length; 1 where the unit is not known.
double metres_per_unit(const ResultHeader& header);

/// The environment in words, by its number of points and its hash.
std::string environment_text(const ResultHeader& header);

/// What a model of so many solids and triangles was searched as, which outputs call model_as:
/// "solid", "surface" or "points".
const char* model_as(std::uint64_t solids, std::uint64_t triangles);

/// What a search found besides its tables. It does not take part in the comparison of questions.
// NOLINTNEXTLINE(bugprone-exception-escape): of messages that are moved
struct ResultFindings {
  std::vector<Message> warnings = {};  ///< see Answer::warnings
  ScanDates scanned = {};              ///< days on which the scans of the environment were made
  /// Number of points of the scans that the store left out because they have the flag `withheld`
  std::uint64_t withheld_points = 0;
  std::uint64_t ignored_colliding = 0, ignored_colliding_high = 0;  ///< see Answer
  /// See Answer. A file has it where there is a floor.
  std::optional<std::uint64_t> floor_colliding = {};
  /// See Answer. A file has it where there is an error budget.
  std::optional<CertainPoints> certain = {};
  /// See Answer. A file has it where seen space is asked for.
  std::optional<SeenSummary> seen = {};
  /// See Answer. A file has it where there are several bodies.
  std::optional<SearchedLength> searched = {};
  /// Runs of poses at which no body has a pose, as poses_without_bodies() gives them. Kept where
  /// several bodies have a profile, which at these poses cannot show what is near.
  std::vector<std::array<std::uint32_t, 2>> without_bodies = {};
};

/// The facts of a result for the header of its file.
Json result_facts(ResultHeader header, ResultFindings findings);

/// Reads the facts of a result or of a part. Throws InputError for those that no run writes.
void read_result_facts(const TableFile& file, ResultHeader& header, ResultFindings& findings);

}  // namespace clearway
