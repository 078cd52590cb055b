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

/// Which part of a result a file is, and how that part was computed.
// NOLINTNEXTLINE(bugprone-exception-escape): of messages that are moved
struct ResultPart {
  Shard shard;
  std::uint64_t division = 0;  ///< hash of how the cells of the store are divided among the parts
  std::uint64_t store = 0;     ///< fingerprint of the store
  std::string length_unit;     ///< unit of the store, for the messages of merge()
  /// Device and, in metres, the steps of the model field and of the grid, on which the answer
  /// depends where it is not exact; otherwise empty and 0.
  std::string device = {};
  double field_voxel = 0, grid_cell = 0;
  std::vector<Message> warnings = {};  ///< warnings of the run that wrote the part
  bool model_is_cut = false;           ///< see SearchOptions::model_is_cut

  /// Whether two parts belong to the same work. How it was done and what was warned of are not
  /// compared.
  friend bool operator==(const ResultPart& a, const ResultPart& b) {
    return a.shard == b.shard && a.division == b.division && a.store == b.store &&
           a.length_unit == b.length_unit;
  }
};

/// The spacing of a model's points in metres (Query::model_spacing), which tells how far the answer
/// may be from that of the surface. The question is about the points alone, so any two spacings
/// compare equal; a result from before this attribute existed remains a result of its question.
struct ModelSpacing {
  double metres = 0;
  friend bool operator==(const ModelSpacing&, const ModelSpacing&) { return true; }
};

/// The query that a result answers. It depends only on the source points, the model, the trajectory
/// and the parameters, and on engine and precision where they affect the answer
/// (docs/design/result-format.md), so that `cmp` compares runs.
struct ResultHeader : QueryParameters {
  std::uint64_t environment_points = 0;
  /// Hash of the source points, the same for every file format and layout.
  std::uint64_t environment_hash = 0;
  std::uint64_t model_points = 0;
  std::uint64_t model_hash = 0;
  std::uint64_t poses = 0;
  std::uint64_t trajectory_hash = 0;
  std::string engine;            ///< engine that searched; empty without a tolerance
  bool float_precision = false;  ///< single precision alone decided, so the result is not exact
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
  /// Whether each colliding point also has a last pose. It does in the result of a search with
  /// first poses, except in those of older releases.
  bool last_pose = false;
  /// Version of the file. Version 2 has no model box, no profile and no coordinates of clearances.
  /// Version 4 ignores points, has bodies, or both.
  std::uint32_t version = 3;

  bool has_poses_of_ways() const { return first_pose && between_poses; }
  bool has_first_bodies() const { return first_pose && !bodies.empty(); }
  /// The version under which a result with these contents is written.
  std::uint32_t written_version() const { return ignores_points() || !bodies.empty() ? 4 : 3; }
  /// Whether the answer is exact. If a tolerance or single precision decided, it depends on how it
  /// was computed.
  bool is_exact() const { return tolerance == 0 && !float_precision; }
  bool has_model_box() const { return version >= 3; }
  bool has_clearance_xyz() const { return version >= 3; }
  friend bool operator==(const ResultHeader&, const ResultHeader&) = default;
};

/// What a search found besides its tables. It does not take part in the comparison of questions.
struct ResultFindings {
  /// Codes of warnings that put the question in doubt, as doubts_among() returns them. A file keeps
  /// them only where nothing collides, because only then do they change the verdict.
  std::vector<std::string> doubts = {};
  /// See Answer. A file has both numbers where points are ignored, unless an earlier release wrote
  /// it.
  std::optional<std::uint64_t> ignored_colliding = {}, ignored_colliding_high = {};
  /// See Answer. A file has it where there are several bodies, unless an earlier release wrote it.
  std::optional<SearchedLength> searched = {};
  /// Runs of poses at which no body has a pose, as poses_without_bodies() gives them. Kept where
  /// several bodies have a profile, which at these poses cannot tell what is near.
  std::vector<std::array<std::uint32_t, 2>> without_bodies = {};
};

/// Writes the datasets that docs/design/result-format.md lists and the header asks for to a file of
/// its own, which the caller publishes. Its bytes depend on header and rows alone. Collisions come
/// first, then clearances, then the profile. All append functions throw std::logic_error for rows
/// out of this order, for more rows than promised, for sources that do not ascend (except in the
/// profile) and for spans of unequal lengths. A failing disk throws ResourceError.
///
/// Instead of appending rows, threads may encode them kEncodedRows at a time; only the last rows of
/// a table may be fewer. The encoded rows are then hashed in order and written in order. One thread
/// at a time may hash and one at a time may write; the two may differ.
class ResultWriter {
 public:
  /// Creates the file at `path`. collisions, clearances: number of rows that will be written. The
  /// profile has one row per pose.
  ResultWriter(const std::filesystem::path& path, const ResultHeader& header,
               std::uint64_t collisions, std::uint64_t clearances = 0);
  ~ResultWriter();

  /// Appends collisions. first_pose, last_pose: empty unless the header has them. body: the body
  /// that touches the point at its first pose; empty unless the header has first poses and bodies.
  void append(std::span<const std::uint64_t> source, std::span<const Vec3> xyz,
              std::span<const std::uint32_t> first_pose, std::span<const std::uint32_t> body = {},
              std::span<const std::uint32_t> last_pose = {});
  /// Appends clearances, with distances in metres. Only where the header asks for clearances. body:
  /// empty unless the header has bodies.
  void append_clearances(std::span<const std::uint64_t> source, std::span<const Vec3> xyz,
                         std::span<const double> distance, std::span<const std::uint32_t> pose,
                         std::span<const std::uint32_t> body = {});
  /// Appends the profile's rows of the next poses, with values as in Profile. Only where the header
  /// asks for a profile. squared: the computed squared distances whose roots are `distance`; empty
  /// unless the header is of a part.
  void append_profile(std::span<const double> distance, std::span<const std::uint64_t> source,
                      std::span<const Vec3> xyz, std::span<const double> chainage,
                      std::span<const double> squared = {});

  /// Empty rows for the caller to fill and seal. Thread safe.
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

/// Whether ResultReader accepts a part of a result in place of a whole one.
enum class Parts { kRefused, kAccepted };

/// Reads a result by ranges of rows, which lie below the number of rows. Reading all of them front
/// to back (result_rows.hpp) also checks them against their hash. Throws InputError when the file
/// is not a complete result, is damaged, or holds rows that no run can have found.
class ResultReader {
 public:
  explicit ResultReader(const std::filesystem::path& path, Parts parts = Parts::kRefused);
  ~ResultReader();
  ResultReader(ResultReader&&) noexcept;
  ResultReader& operator=(ResultReader&&) noexcept;

  const std::string& name() const;  ///< path of the file, for messages
  const ResultHeader& header() const;
  const ResultFindings& findings() const;
  std::uint64_t collisions() const;
  /// ColumnHashes of source, xyz and, where the result has them, first_pose and body.
  std::uint64_t collisions_hash() const;
  /// Reads source indices, which are strictly ascending and below header().environment_points.
  void read_source(std::uint64_t first, std::span<std::uint64_t> out) const;
  void read_xyz(std::uint64_t first, std::span<Vec3> out) const;
  /// Reads first poses, which are below header().poses. Only where the header has first poses.
  void read_first_pose(std::uint64_t first, std::span<std::uint32_t> out) const;
  /// Reads last poses, which are below header().poses. Only where header().last_pose is set.
  void read_last_pose(std::uint64_t first, std::span<std::uint32_t> out) const;
  /// XXH64 of the last poses; 0 where the result has none.
  std::uint64_t last_pose_hash() const;
  /// Reads the bodies that touch the points at their first poses, as indices below the number of
  /// bodies. Only where header().has_first_bodies().
  void read_first_body(std::uint64_t first, std::span<std::uint32_t> out) const;
  /// Reads source, xyz and first_pose together, and adds each column to its hash. first_pose: empty
  /// unless the header has it. Uses many threads where `first` is a multiple of kEncodedRows and
  /// the number of rows is one too, or reaches the end of the table.
  void read_collisions(std::uint64_t first, std::span<std::uint64_t> source, std::span<Vec3> xyz,
                       std::span<std::uint32_t> first_pose, std::span<Xxh64Stream> hashes) const;

  /// Number of clearances; 0 where the header has none.
  std::uint64_t clearances() const;
  /// ColumnHashes of source, xyz (where the header has it), distance, pose and, where there are
  /// bodies, body; 0 where there are no clearances.
  std::uint64_t clearances_hash() const;
  /// Reads clearances: source and pose are as in read_source() and read_first_pose(); distances are
  /// in metres, at most header().clearance, and below 0 only for models with solids. Only where the
  /// header has clearances. xyz: empty unless the header has them.
  void read_clearances(std::uint64_t first, std::span<std::uint64_t> source, std::span<Vec3> xyz,
                       std::span<double> distance, std::span<std::uint32_t> pose) const;
  /// Reads clearances and adds each column to its hash; without xyz, the hashes are of the other
  /// three columns in order. Uses many threads where read_collisions() does.
  void read_clearances(std::uint64_t first, std::span<std::uint64_t> source, std::span<Vec3> xyz,
                       std::span<double> distance, std::span<std::uint32_t> pose,
                       std::span<Xxh64Stream> hashes) const;

  /// Reads the bodies that have the clearances, as indices below the number of bodies. Only where
  /// the header has clearances and bodies.
  void read_clearance_body(std::uint64_t first, std::span<std::uint32_t> out) const;

  /// Number of rows of the profile: header().poses, or 0 where the header has no profile.
  std::uint64_t profile_rows() const;
  /// ColumnHashes of distance, source, xyz, chainage and, in a part, squared; 0 where there is no
  /// profile.
  std::uint64_t profile_hash() const;
  /// Reads the profile, with values as in Profile; chainage is 0 at the first pose and does not
  /// descend. Only where the header has a profile.
  void read_profile(std::uint64_t first, std::span<double> distance,
                    std::span<std::uint64_t> source, std::span<Vec3> xyz,
                    std::span<double> chainage) const;
  /// Reads the squared distances whose roots are the profile's distances. Only where the file is a
  /// part.
  void read_profile_squared(std::uint64_t first, std::span<double> out) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
