#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/box.hpp"
#include "clearway/error_budget.hpp"
#include "clearway/ignored.hpp"
#include "clearway/progress.hpp"
#include "clearway/query.hpp"
#include "clearway/shard.hpp"
#include "clearway/unsearched.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/files/hdf5.hpp"
#include "io/scans/scan_dates.hpp"

namespace clearway {

/// Which part of a result a file is, and how that part was computed.
struct ResultPart {
  Shard shard;
  std::uint64_t division = 0;  ///< hash of how the cells of the store are divided among the parts
  std::uint64_t store = 0;     ///< fingerprint of the store
  std::string length_unit;     ///< unit of the store, for the messages of merge()
  bool model_is_cut = false;   ///< see SearchOptions::model_is_cut

  /// Whether two parts belong to the same work. How it was done is not compared.
  friend bool operator==(const ResultPart& a, const ResultPart& b) {
    return a.shard == b.shard && a.division == b.division && a.store == b.store &&
           a.length_unit == b.length_unit;
  }
};

/// The spacing of a model's points in metres (Query::model_spacing), which shows how far the answer
/// may be from that for the surface. It is not part of the question, which is about the points
/// alone. So any two spacings compare equal, and a result without this attribute, from an earlier
/// release, still answers the same question.
struct ModelSpacing {
  double metres = 0;
  friend bool operator==(const ModelSpacing&, const ModelSpacing&) { return true; }
};

/// The axes of the model's file that pointed ahead and up before the model was turned (file_axes()
/// of the query). They are not part of the question, which is about the turned model, so any two
/// compare equal.
struct KeptAxes {
  ModelAxes axes = {};
  friend bool operator==(const KeptAxes&, const KeptAxes&) { return true; }
};

/// The query that a result answers. It depends only on the source points, the model, the trajectory
/// and the parameters (docs/design/result-format.md), so that `cmp` compares runs.
struct ResultHeader : QueryParameters {
  std::uint64_t environment_points = 0;
  /// Hash of the source points, the same for every file format and layout.
  std::uint64_t environment_hash = 0;
  std::uint64_t model_points = 0;
  std::uint64_t model_hash = 0;
  std::uint64_t poses = 0;
  std::uint64_t trajectory_hash = 0;
  Quantisation quantisation{};
  std::string crs_wkt;
  /// Between poses, the first poses are those of version 0.1.0, whose ways did not include their
  /// ends.
  bool ways_without_ends = false;
  Box model_box{};                 ///< box of the model's points
  std::optional<ResultPart> part;  ///< set where the file is one of the parts that merge() combines
  /// Number of triangles of a mesh, whose corners are the model's points; for several bodies, of
  /// all of them. 0 where the model is points.
  std::uint64_t model_triangles = 0;
  /// Number of parts of the model that have an inside; where there are any, distances may be below
  /// 0.
  std::uint64_t model_solids = 0;
  /// Numbers of points for ignore_classes and ignore_boxes, whose order is that of sort_ignored().
  IgnoredPointCounts ignored{};
  /// Hash of the classes of all points; 0 where no class is ignored.
  std::uint64_t classes_hash = 0;
  /// Names of the bodies; empty unless the query has several.
  std::vector<std::string> bodies = {};
  ModelSpacing model_spacing{};  ///< the greatest spacing of all bodies
  KeptAxes model_axes{};
  /// Whether each colliding point also has a last pose. It does in the result of a search with
  /// first poses, except in those of older releases.
  bool last_pose = false;
  /// The error budget, if the query has one. It decides where /near ends.
  std::optional<ErrorBudget> budget = {};
  /// Version of the file. Version 2 has no model box, no profile and no coordinates of clearances.
  /// Version 4 ignores points, has bodies, or both. Version 5 has an error budget, seen space or
  /// both, and may have what version 4 has.
  std::uint32_t version = 3;

  bool has_poses_of_ways() const { return first_pose && between_poses; }
  bool has_first_bodies() const { return first_pose && !bodies.empty(); }
  /// The version under which a result with these contents is written.
  std::uint32_t written_version() const {
    if (budget || seen) return 5;
    return ignores_points() || !bodies.empty() ? 4 : 3;
  }
  bool has_model_box() const { return version >= 3; }
  bool has_clearance_xyz() const { return version >= 3; }
  friend bool operator==(const ResultHeader&, const ResultHeader&) = default;
};

/// The environment in words, by its number of points and its hash.
std::string environment_text(const ResultHeader& header);

/// What a search found besides its tables. It does not take part in the comparison of questions.
// NOLINTNEXTLINE(bugprone-exception-escape): of messages that are moved
struct ResultFindings {
  std::vector<Message> warnings = {};  ///< see Answer::warnings
  ScanDates scanned = {};              ///< days on which the scans of the environment were made
  /// Number of points of the scans that the store left out because they have the flag `withheld`
  std::uint64_t withheld_points = 0;
  /// See Answer. A file has both numbers where points are ignored, unless an earlier release wrote
  /// it.
  std::optional<std::uint64_t> ignored_colliding = {}, ignored_colliding_high = {};
  /// See Answer. A file has it where there is an error budget.
  std::optional<CertainPoints> certain = {};
  /// See Answer. A file has it where seen space is asked for.
  std::optional<SeenSummary> seen = {};
  /// See Answer. A file has it where there are several bodies, unless an earlier release wrote it.
  std::optional<SearchedLength> searched = {};
  /// Runs of poses at which no body has a pose, as poses_without_bodies() gives them. Kept where
  /// several bodies have a profile, which at these poses cannot tell what is near.
  std::vector<std::array<std::uint32_t, 2>> without_bodies = {};
};

/// Writes the attributes of a new result except its hashes and `complete`, and the lists of what it
/// ignores.
void write_result_header(const hdf5::Id& file, const ResultHeader& header);

/// Reads the header of a result or of a part. name: the file's, for messages. Throws InputError
/// where the file is not a complete result, or is damaged.
ResultHeader read_result_header(const hdf5::Id& file, const std::string& name);

/// Writes the warnings as a group, and the other findings as attributes; those that are empty have
/// none.
void write_result_findings(const hdf5::Id& file, const ResultFindings& findings);

/// Reads the findings. header: the header of the same file. Throws InputError where an attribute is
/// damaged, or the group of warnings is missing.
ResultFindings read_result_findings(const hdf5::Id& file, const std::string& name,
                                    const ResultHeader& header);

}  // namespace clearway
