#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/ignored.hpp"
#include "clearway/progress.hpp"
#include "clearway/query.hpp"
#include "clearway/shard.hpp"
#include "clearway/unsearched.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/result/encoded_rows.hpp"
#include "io/system/xxh64.hpp"

namespace clearway {

/// What makes a result one part of several.
// NOLINTNEXTLINE(bugprone-exception-escape): of messages that are moved
struct ResultPart {
  Shard shard;
  std::uint64_t division = 0;  ///< hash of which cells of which store are in which part
  std::uint64_t store = 0;     ///< its fingerprint
  std::string length_unit;     ///< of the store: for what merge() says
  /// What the answer depends on where it is not exact; otherwise empty and 0. Metres.
  std::string device = {};
  double field_voxel = 0, grid_cell = 0;
  std::vector<Message> warnings = {};  ///< of the run that wrote it
  bool model_is_cut = false;           ///< as SearchOptions::model_is_cut

  /// Of the same work: how it was done, and what was warned of, are not compared.
  friend bool operator==(const ResultPart& a, const ResultPart& b) {
    return a.shard == b.shard && a.division == b.division && a.store == b.store &&
           a.length_unit == b.length_unit;
  }
};

/// The spacing of a model's points, as Query::model_spacing. It tells how far the answer may be
/// from that of the surface, and is no part of the question, which the points alone are: any two
/// are equal, so that results from before there was the attribute stay results of their questions.
struct ModelSpacing {
  double metres = 0;
  friend bool operator==(const ModelSpacing&, const ModelSpacing&) { return true; }
};

/// What a result says of its query: a function of the source points, the model, the trajectory
/// and the parameters, and but for the engine and the precision where they are part of the answer,
/// of nothing else (docs/design/result-format.md), so that `cmp` compares runs.
struct ResultHeader : QueryParameters {
  std::uint64_t environment_points = 0;
  std::uint64_t environment_hash = 0;  ///< of the source points, whatever file format or layout
  std::uint64_t model_points = 0;
  std::uint64_t model_hash = 0;
  std::uint64_t poses = 0;
  std::uint64_t trajectory_hash = 0;
  std::string engine;            ///< that searched; only with a tolerance
  bool float_precision = false;  ///< floats alone decided: not an exact result
  Quantisation quantisation{};
  std::string crs_wkt;
  /// First poses between poses are those of version 0.1.0, whose ways did not include their ends.
  bool ways_without_ends = false;
  Box model_box{};                 ///< of the model's points
  std::optional<ResultPart> part;  ///< of what merge() makes a result of
  /// Of a surface, whose corners the model's points are; 0: the points are the model. Of several
  /// bodies those of all.
  std::uint64_t model_triangles = 0;
  std::uint64_t model_solids = 0;  ///< parts of it with an inside; then distances may be below 0
  IgnoredPointCounts ignored{};  ///< of ignore_classes and ignore_boxes, as sort_ignored() has them
  std::uint64_t classes_hash = 0;        ///< of all points; 0 where no class is ignored
  std::vector<std::string> bodies = {};  ///< names, of a query with several; else none
  ModelSpacing model_spacing{};          ///< the greatest of all bodies
  /// Whether each colliding point has a last pose too. Results of a search with first poses do;
  /// those of older releases do not.
  bool last_pose = false;
  /// Of the file. Version 2 has no model box, no profile and no coordinates of clearances. Version
  /// 4 ignores points, has bodies, or both.
  std::uint32_t version = 3;

  bool has_poses_of_ways() const { return first_pose && between_poses; }
  bool has_first_bodies() const { return first_pose && !bodies.empty(); }
  /// The version that a file with these contents has.
  std::uint32_t written_version() const { return ignores_points() || !bodies.empty() ? 4 : 3; }
  /// Whether floats or a tolerance decided: then it depends on how it was computed.
  bool is_exact() const { return tolerance == 0 && !float_precision; }
  bool has_model_box() const { return version >= 3; }
  bool has_clearance_xyz() const { return version >= 3; }
  friend bool operator==(const ResultHeader&, const ResultHeader&) = default;
};

/// What a search found out beside its tables. It is no part of the question, so results of the same
/// question are not told apart by it.
struct ResultFindings {
  /// Codes of warnings that put the question in doubt, as doubts_among() has them. A file keeps
  /// them where nothing collides, because only then do they change the verdict.
  std::vector<std::string> doubts = {};
  /// As Answer has them. A file has both where points are ignored, unless an earlier release wrote
  /// it.
  std::optional<std::uint64_t> ignored_colliding = {}, ignored_colliding_high = {};
  /// As Answer has it. A file has it where there are several bodies, unless an earlier release
  /// wrote it.
  std::optional<SearchedLength> searched = {};
  /// As poses_without_bodies() has them, where there is a profile of several bodies: there it is
  /// not known what is near.
  std::vector<std::array<std::uint32_t, 2>> without_bodies = {};
};

/// Writes the datasets that docs/design/result-format.md lists and the header asks for, to a file
/// of its own; the caller publishes it. Its bytes depend on header and rows alone. Collisions come
/// first, then clearances, then the profile. All append functions throw std::logic_error for rows
/// out of this order, more rows than promised, sources that do not ascend (but in the profile) and
/// spans of unequal lengths. A failing disk throws ResourceError.
///
/// Instead of appending rows, threads may encode them kEncodedRows at a time, fewer only at the
/// end of a table. These are then hashed in order, and written in order, one at a time each; one
/// thread may hash while another writes.
class ResultWriter {
 public:
  /// The profile has a row a pose.
  ResultWriter(const std::filesystem::path& path, const ResultHeader& header,
               std::uint64_t collisions, std::uint64_t clearances = 0);
  ~ResultWriter();

  /// The next rows. first_pose: empty unless the header has it; body, of the first pose, and
  /// last_pose likewise.
  void append(std::span<const std::uint64_t> source, std::span<const Vec3> xyz,
              std::span<const std::uint32_t> first_pose, std::span<const std::uint32_t> body = {},
              std::span<const std::uint32_t> last_pose = {});
  /// The next clearances; distance in metres. Only where the header asks for them. body: empty
  /// unless the header has bodies.
  void append_clearances(std::span<const std::uint64_t> source, std::span<const Vec3> xyz,
                         std::span<const double> distance, std::span<const std::uint32_t> pose,
                         std::span<const std::uint32_t> body = {});
  /// The next poses' rows, as Profile has them. Only where the header asks for a profile. squared:
  /// the computed d2 of which distance is the root; empty unless the header is of a part.
  void append_profile(std::span<const double> distance, std::span<const std::uint64_t> source,
                      std::span<const Vec3> xyz, std::span<const double> chainage,
                      std::span<const double> squared = {});

  /// To be filled and sealed. Thread safe.
  EncodedCollisions new_collisions() const;
  EncodedClearances new_clearances() const;
  void hash(const EncodedCollisions& rows);
  void hash(const EncodedClearances& rows);
  void write(EncodedCollisions& rows);
  void write(EncodedClearances& rows);

  /// Writes the findings and closes the file. Throws std::logic_error unless as many rows as
  /// promised were appended.
  void finish(const ResultFindings& findings = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Whether a part of a result will do.
enum class Parts { kRefused, kAccepted };

/// Reads a result by ranges of rows, which lie below the number of rows; whoever reads all of them
/// front to back (result_rows.hpp) checks them against their hash too. Throws InputError when the
/// file is not a complete result, is damaged, or holds rows that no run can have found.
class ResultReader {
 public:
  explicit ResultReader(const std::filesystem::path& path, Parts parts = Parts::kRefused);
  ~ResultReader();
  ResultReader(ResultReader&&) noexcept;
  ResultReader& operator=(ResultReader&&) noexcept;

  const std::string& name() const;  ///< the file's, for messages
  const ResultHeader& header() const;
  const ResultFindings& findings() const;
  std::uint64_t collisions() const;
  /// ColumnHashes of source, xyz and, where there are such, first_pose and body.
  std::uint64_t collisions_hash() const;
  /// Strictly ascending and below header().environment_points.
  void read_source(std::uint64_t first, std::span<std::uint64_t> out) const;
  void read_xyz(std::uint64_t first, std::span<Vec3> out) const;
  /// Below header().poses. Only where the header has first poses.
  void read_first_pose(std::uint64_t first, std::span<std::uint32_t> out) const;
  /// The same of header().last_pose.
  void read_last_pose(std::uint64_t first, std::span<std::uint32_t> out) const;
  /// XXH64 of the last poses; 0 without any.
  std::uint64_t last_pose_hash() const;
  /// Below the number of bodies. Only where the header has_first_bodies().
  void read_first_body(std::uint64_t first, std::span<std::uint32_t> out) const;
  /// Those three; first_pose: empty unless the header has it. Adds the columns to their hashes.
  /// With many threads where first is a multiple of kEncodedRows, and so is their number or they
  /// are the last ones.
  void read_collisions(std::uint64_t first, std::span<std::uint64_t> source, std::span<Vec3> xyz,
                       std::span<std::uint32_t> first_pose, std::span<Xxh64Stream> hashes) const;

  /// Rows of the clearances, 0 where the header has none.
  std::uint64_t clearances() const;
  /// ColumnHashes of source, xyz (where the header has it), distance, pose and, where there are
  /// bodies, body; 0 without any.
  std::uint64_t clearances_hash() const;
  /// source as read_source, distance from 0 to header().clearance, pose as read_first_pose. Only
  /// where the header has clearances. xyz: empty unless the header has them.
  void read_clearances(std::uint64_t first, std::span<std::uint64_t> source, std::span<Vec3> xyz,
                       std::span<double> distance, std::span<std::uint32_t> pose) const;
  /// The same. Adds the columns to their hashes, but xyz where there is none. With many threads as
  /// read_collisions().
  void read_clearances(std::uint64_t first, std::span<std::uint64_t> source, std::span<Vec3> xyz,
                       std::span<double> distance, std::span<std::uint32_t> pose,
                       std::span<Xxh64Stream> hashes) const;

  /// Below the number of bodies. Only where the header has clearances and bodies.
  void read_clearance_body(std::uint64_t first, std::span<std::uint32_t> out) const;

  /// Rows of the profile: header().poses, or 0 where the header has none.
  std::uint64_t profile_rows() const;
  /// ColumnHashes of distance, source, xyz, chainage and, of a part, squared; 0 where there is
  /// none.
  std::uint64_t profile_hash() const;
  /// As Profile says; chainage from 0 at the first pose, ascending. Only where the header has it.
  void read_profile(std::uint64_t first, std::span<double> distance,
                    std::span<std::uint64_t> source, std::span<Vec3> xyz,
                    std::span<double> chainage) const;
  /// Of a part only: the d2 of which the distances are roots.
  void read_profile_squared(std::uint64_t first, std::span<double> out) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
