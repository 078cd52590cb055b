#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/file_unit.hpp"
#include "clearway/progress.hpp"
#include "clearway/trajectory.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// How scans are converted. Every member has a value, so that {.memory_bytes = ...} compiles
/// without a warning.
struct ConvertOptions {
  /// Step of the stored integers, in metres. None: the step of the input, or else the finest power
  /// of ten from 1e-6 to 1e-3 that fits.
  std::optional<double> scale = std::nullopt;
  std::uint32_t cell_points = 65536;  ///< points of a cell, 64 to 2^20
  /// Side of the cubes that cells are, in metres; none: cells are adaptive.
  std::optional<double> regular_size = std::nullopt;
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  int threads = 0;  ///< 0: all cores
  /// The unit of the coordinates of inputs that name none: the metre, or a foot. Inputs that name a
  /// unit must name this one. None: the unit stays unknown and is treated as the metre.
  FileUnit unit = {};
  /// The unit of the heights of all inputs, which are then converted to the unit of the other
  /// coordinates. Inputs that name a unit of heights must name this one. None: heights are in the
  /// unit of the other coordinates.
  FileUnit unit_z = {};
  /// Takes coordinates as they are where they are in degrees or in different units, where their
  /// coordinate reference system is not read, and where it is a map that does not keep lengths.
  bool ignore_crs = false;
  /// Columns of x, y and z in text files: numbers counted from 1, or names of the header. Empty: as
  /// the files declare them.
  std::vector<std::string> columns = {};
  /// A CSV file with the header first,x,y,z, in the unit of the environment: from source index
  /// `first` on, the scanner stood at x, y, z. It replaces what the scans say of their origins.
  /// Empty: the origins are those of the scans, where they have any.
  std::filesystem::path origins = {};
  /// A trajectory with times: each point of LAS and LAZ inputs was seen from where the scanner was
  /// at the point's GPS time. It replaces what the scans say of their origins, and excludes
  /// `origins`. Empty: there is none.
  std::filesystem::path origins_path = {};
  /// How origins_path and near are read. The environment's unit and coordinate reference system are
  /// filled in, and its own lever_arm does not count.
  TrajectoryOptions path_options = {};
  /// Where the scanner is in the frame of the poses of origins_path, metres whatever the unit of
  /// the environment: it is at p + R lever_arm for a pose with the position p and the rotation R.
  Vec3 lever_arm{0, 0, 0};
  /// A trajectory: the store holds only the points whose distance to the path of its positions, the
  /// segments between consecutive ones, is at most `within`. Scale, offset and source indices are
  /// those of converting everything. Questions whose answer could depend on a point that was left
  /// out are refused.
  std::filesystem::path near = {};
  /// Metres whatever the unit of the environment, above 0; only with `near`, which needs it.
  double within = 0;
  /// Does not read LAS and LAZ files whose header's bounds are farther than `within` from the path.
  /// A header that is wrong then makes points disappear. Only with `near`.
  bool trust_bounds = false;
  /// Keeps points with the flag `withheld` of LAS and LAZ, which otherwise are left out as deleted.
  bool keep_withheld = false;
  bool skip_unreadable = false;  ///< leaves out files that cannot be read, with a warning
  bool strict = false;     ///< treats warnings as errors: reports all of them and writes no store
  bool overwrite = false;  ///< replaces an existing store
  /// Goes on with a conversion of the same inputs and options that was interrupted, and leaves
  /// their store as it is where it is finished. No other store is overwritten.
  bool resume = false;
  ProgressCallback progress = nullptr;
  MessageCallback message = nullptr;  ///< receives notes, and the warnings that the report holds
  StopFlag stop = nullptr;
};

/// How long all threads together were busy with a stage of a conversion.
struct StageSeconds {
  std::string stage;
  double seconds = 0;
};

/// How the points found their places on ConvertOptions::origins_path. Times are seconds.
struct OriginsPathReport {
  /// What the times of points and path are: "week-seconds", "adjusted" (standard GPS time),
  /// "mixed" for files that differ, and for a path also "standard" (any other epoch).
  std::string point_clock, path_clock;
  double first_point = 0, last_point = 0;  ///< least and greatest time, as in the files
  double first_pose = 0, last_pose = 0;
  /// What was added to times of points to compare them with the path, ascending; one value where
  /// all files count alike.
  std::vector<double> shifts = {};
  std::uint64_t before = 0, after = 0;  ///< points from before the first and after the last pose
  std::uint64_t in_gaps = 0;            ///< points from between poses more than 1 s apart
  std::uint64_t without_time = 0;       ///< points without a finite GPS time
};

struct ConvertReport {
  /// True if the store existed already, so that nothing was converted. Then only what the store
  /// keeps is known, and records without a point count as points that are not finite.
  bool was_finished = false;
  std::uint64_t points = 0;  ///< number of points stored
  std::uint64_t cells = 0;
  /// Number of points left out because a coordinate is not finite
  std::uint64_t non_finite_points = 0;
  /// Number of records without a point, such as beams without a return
  std::uint64_t absent_points = 0;
  /// Number of points left out because they have the flag `withheld`, and of those that were stored
  /// although they have it, as ConvertOptions::keep_withheld wants
  std::uint64_t withheld_points = 0, kept_withheld_points = 0;
  /// Number of points left out because they are farther than ConvertOptions::within from the path;
  /// and of those, points that were not even read
  std::uint64_t far_points = 0, unread_points = 0;
  /// Number of files that were not read because of ConvertOptions::trust_bounds
  std::uint64_t passed_over_files = 0;
  /// Number of distinct places from which points were seen; 0 if that is known for no point
  std::uint64_t origins = 0;
  /// Number of stored points for which it is not known from where they were seen
  std::uint64_t points_without_origin = 0;
  /// Only with ConvertOptions::origins_path
  std::optional<OriginsPathReport> origins_path = std::nullopt;
  Vec3 scale{}, offset{};  ///< scale and offset of the stored integers, metres
  /// Box around the points of the inputs, with those that are too far from a path; none if there
  /// are no points
  std::optional<Box> box = std::nullopt;
  double largest_change = 0;  ///< greatest change of a coordinate by rounding to the scale, metres
  std::uint64_t temporary_bytes = 0;
  std::uint64_t output_bytes = 0;
  /// What an interrupted call had come to, which was taken over because ConvertOptions::resume is
  /// set: "the inputs were inspected", "all points were counted" or "all points were distributed".
  /// Empty where nothing was taken over
  std::string resumed_from = {};
  /// Wall-clock seconds of the stages; count_seconds includes everything before that stage.
  double count_seconds = 0, distribute_seconds = 0, partition_seconds = 0, confirm_seconds = 0;
  std::vector<StageSeconds> busy_seconds = {};
  std::vector<Message> warnings = {};
};

/// Converts scans into a store. The inputs are LAS, LAZ, E57, PLY, PCD, PTX, PTS, 3DTK and text;
/// files and folders, or "-" alone for LAS or LAZ on standard input. Throws UsageError, InputError,
/// ResourceError; Interrupted when asked to stop. Whatever happens, only a complete store ever has
/// the output's name.
ConvertReport convert(const std::vector<std::filesystem::path>& inputs,
                      const std::filesystem::path& output, const ConvertOptions& options = {});

}  // namespace clearway
