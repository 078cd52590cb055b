#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/device.hpp"
#include "clearway/follow.hpp"
#include "clearway/outline.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/store.hpp"
#include "clearway/vec3.hpp"

/// The section of a route: which cells of the cross-section are blocked for a load of a given
/// length, from which pose on. It answers for every outline what is the largest load that passes.
namespace clearway {

/// The part of the cross-section that is looked at, in the frame of the load: y to the left, z up.
struct SectionWindow {
  double y_from = 0, y_to = 0, z_from = 0, z_to = 0;
  friend bool operator==(const SectionWindow&, const SectionWindow&) = default;
};

/// The question about a route. Lengths are in the environment's unit.
struct SectionParameters {
  /// The load occupies x from rear to front in its own frame.
  double rear = 0, front = 0;
  /// The window of the cross-section; none: y from -4 to 4 m, z from 0 to 6 m.
  std::optional<SectionWindow> window = {};
  double cell = 0;  ///< side of a cell; 0: 0.02 m
  double bin = 0;   ///< length of the stretches into which the path is divided; 0: 5 m
  /// The greatest distance that a later check may keep: points as far before the rear and behind
  /// the front count too.
  double margin = 0;
  /// Whether the way from each pose to the next counts, too, by letting the load grow.
  bool between_poses = false;
  /// The places of the load that lie on the path, as for a body on pivots; none: the load has the
  /// poses of the path.
  std::optional<BodyPivots> pivots = {};
  std::vector<std::uint8_t> ignore_classes = {};  ///< classes whose points are left out
  std::vector<Box> ignore_boxes = {};             ///< closed boxes whose points are left out
  /// Whether cells that no beam of the scanner crossed are distinguished as not known. The store
  /// has to know where its scanner stood.
  bool seen = false;
  /// Side of the cubes of space in which beams are followed; 0: 0.2 m.
  double seen_cube = 0;
};

/// How a section is found. The file's bytes depend on none of these options.
struct SectionOptions {
  Device device = Device::kAuto;  ///< kAuto: a GPU that has room and pays, or else the CPU
  std::vector<int> gpus = {};     ///< CUDA's device numbers; empty: the first GPU with room
  int threads = 0;                ///< 0: all cores
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  std::uint64_t device_memory_bytes = 0;  ///< budget on each device; 0: 2 GiB, or what is free
  bool overwrite = false;
  bool strict = false;  ///< any warning ends with InputError, and nothing is written
  /// Warnings from reading the path, which the user has already seen. The section keeps them, and
  /// `strict` counts them.
  std::vector<Message> input_warnings = {};
  ProgressCallback progress = nullptr;
  MessageCallback message = nullptr;
  StopFlag stop = nullptr;
};

/// Cells that ignored points would block somewhere on the path, and that no other point blocks
/// anywhere on it.
struct SectionIgnoredCells {
  std::uint64_t blocked = 0;
  /// Those of them that begin more than 0.5 m above z = 0, where the wheels stand, however low the
  /// window begins
  std::uint64_t high = 0;

  friend bool operator==(const SectionIgnoredCells&, const SectionIgnoredCells&) = default;
};

/// What is known of a section besides its cells.
struct SectionFacts {
  SectionParameters parameters;          ///< with the defaults filled in
  std::uint64_t environment_points = 0;  ///< points of the environment
  std::uint64_t ignored_points = 0;      ///< points of it that were left out
  /// The cells that are free only because points were left out; none where nothing was to be left
  /// out
  std::optional<SectionIgnoredCells> ignored_cells = {};
  std::uint64_t poses = 0;       ///< poses of the path
  std::uint64_t load_poses = 0;  ///< poses of the load
  /// Upper bound on the rounding of a place in the frame of the load.
  double rounding = 0;
  /// Between poses: how far the load moves along x, and across, from a pose to the next.
  std::optional<std::array<double, 2>> motion = {};
  std::vector<Message> warnings = {};
  std::string crs_wkt = {};      ///< coordinate reference system of the environment, or empty
  std::string length_unit = {};  ///< as Store::length_unit() names it
};

/// Cells that are blocked, or not known. A cell holds y from j to j + 1 and z from k to k + 1
/// cells.
struct SectionCells {
  std::vector<std::uint32_t> bin = {};  ///< number of the bin; empty for those of the whole path
  std::vector<std::int32_t> j = {}, k = {};
  /// The first pose of the path at which the cell is blocked, or not known.
  std::vector<std::uint32_t> first_pose = {};

  std::size_t size() const { return j.size(); }
  /// Makes room for so many cells of bins.
  void reserve(std::size_t cells);
  friend bool operator==(const SectionCells&, const SectionCells&) = default;
};

/// A section as it is found and kept.
struct SectionData : SectionFacts {
  std::vector<double> chainage = {};  ///< of each pose of the path
  /// Numbers of the bins in which the load has a pose, ascending. Between poses each pose is in all
  /// bins of half of the way to its neighbours, so that none on the way is missing.
  std::vector<std::uint32_t> bins = {};
  SectionCells bin_cells = {};  ///< blocked cells, ascending by bin, k, j
  /// With seen space: cells that are not known, ascending by bin, k, j. A cell that is blocked at
  /// that pose of the bin or before is not among them.
  std::optional<SectionCells> unknown = {};
  /// Hashes of the points of the environment, in whatever store, and of the path.
  std::uint64_t environment_hash = 0, trajectory_hash = 0;

  /// The blocked cells of the whole path, ascending by k, j.
  SectionCells cells() const;
  /// The cells of the whole path that are not known, ascending by k, j, but for those that are
  /// blocked at that pose or before; none without seen space.
  SectionCells unknown_cells() const;
};

/// How many cells no beam of the scanner crossed.
struct SectionSeenCounts {
  double cube = 0;                    ///< side of the cubes of space, as it was asked for
  std::uint64_t unknown = 0;          ///< cells that are not known anywhere on the path
  std::uint64_t unknown_in_bins = 0;  ///< sum over the bins
};

/// How a section was found.
struct SectionReport {
  std::uint64_t blocked = 0;          ///< cells that are blocked anywhere
  std::uint64_t blocked_in_bins = 0;  ///< sum over the bins
  std::uint64_t bins = 0;             ///< as SectionData::bins has them
  double rounding = 0;
  std::optional<std::array<double, 2>> motion = {};
  std::uint64_t ignored_points = 0;                       ///< points that were left out
  std::optional<SectionIgnoredCells> ignored_cells = {};  ///< as SectionFacts has them
  std::optional<SectionSeenCounts> seen = {};             ///< where seen space was asked for
  std::vector<Message> warnings = {};
  Device device = Device::kCpu;            ///< the device that searched
  std::string device_name = "the CPU";     ///< name of the device for the user
  std::optional<DeviceEstimate> estimate;  ///< the estimate by which kAuto chose the device
  std::uint64_t needed_host_bytes = 0;     ///< greatest memory that the search takes
  std::uint64_t peak_device_bytes = 0;     ///< allocated on the GPU, without the CUDA context
  double seconds = 0;                      ///< of the whole call
  double search_seconds = 0;               ///< for blocking the cells, without the two below
  double engine_seconds = 0;               ///< for making engines on GPUs with their slots
  double context_wait_seconds = 0;         ///< that the search waited for the GPUs to start
};

/// Finds the section of a path in a store and writes it to a file. Throws UsageError for an empty
/// range or window, for poses that scale or are singular, for seen space in a store without
/// origins, and for an output that exists; InputError for a damaged store; ResourceError where the
/// memory is too little, with the coarser bin that fits, or where a GPU is asked for and cannot be
/// used; Interrupted when asked to stop.
/// docs/design/section.md has the definitions.
SectionReport find_section(const Store& store, const std::vector<Pose>& path,
                           const SectionParameters& parameters, const std::filesystem::path& output,
                           const SectionOptions& options = {});

/// Whether a load passes.
enum class SectionVerdict { kPasses, kStopped, kUnknown };

const char* name_of(SectionVerdict verdict);  ///< "passes", "stopped" or "unknown"

/// What reaches into a load, or into its margin, from one side on one stretch of the path. The
/// sides are those on which the load has to give way least, in sum, so that something of it is
/// left; they are left and right where nothing would be left. Each cell that stops the load counts
/// on that one of them where it reaches in least.
struct SectionIntrusion {
  Side side = Side::kUnknown;  ///< left, right, above or below, looking forward
  /// How much narrower on this side, or lower, or higher from below, the load would have to be at
  /// the place of the deepest cell. A load that gives way by the depths of all intrusions of a
  /// stretch passes there; at the round corners of a margin less may be enough.
  double depth = 0;
  std::uint64_t cells = 0;             ///< cells that stop the load on this side
  std::uint32_t first_pose = 0;        ///< the first pose of the bin that blocks the deepest cell
  double chainage = 0;                 ///< of that pose
  std::array<std::int32_t, 2> cell{};  ///< j, k of the deepest cell: the least k, then the least j
  /// The rectangle around the cells.
  double y_from = 0, y_to = 0, z_from = 0, z_to = 0;
};

/// A place that stops a load, or that is not known.
struct SectionStop {
  std::uint32_t bin = 0;               ///< number of the bin
  std::uint32_t first_pose = 0;        ///< the first pose of the bin that stops the load
  double chainage = 0;                 ///< of that pose
  std::array<std::int32_t, 2> cell{};  ///< j, k: of that pose, the least k, and then the least j
  std::vector<SectionIntrusion> intrusions = {};  ///< of the bin: left, right, above, below
  std::size_t row = 0;  ///< of a table of outlines: index of the row that is judged here
};

struct SectionCheck {
  SectionVerdict verdict = SectionVerdict::kUnknown;
  std::string reason = {};               ///< why it is unknown, as a clause; otherwise empty
  std::optional<SectionStop> stop = {};  ///< the first place where the load is stopped
  std::vector<SectionStop> stops = {};   ///< the first place in each bin that stops it, ascending
  /// The first place in each bin where the load needs a cell that is not known, ascending; empty
  /// without seen space.
  std::vector<SectionStop> unknowns = {};
};

/// Consecutive bins of a section, from the first to the last one.
struct SectionBinRange {
  std::uint32_t first = 0, last = std::numeric_limits<std::uint32_t>::max();

  bool contains(std::uint32_t bin) const { return first <= bin && bin <= last; }
  friend bool operator==(const SectionBinRange&, const SectionBinRange&) = default;
};

/// The answer to one row of a table of outlines.
struct OutlineRowCheck {
  std::uint64_t line = 0;                     ///< line of the table
  std::filesystem::path file = {};            ///< of the outline, as the table names it
  double chainage_from = 0, chainage_to = 0;  ///< of the row, along the path
  double margin = 0;                          ///< the distance that was kept
  /// The bins that were judged: those that the row touches. None where it touches none in which the
  /// load has a pose, so that it judges nothing.
  std::optional<SectionBinRange> bins = {};
  SectionCheck check = {};
};

/// A stretch of the path for which no row of a table has an outline.
struct OutlineGap {
  double chainage_from = 0, chainage_to = 0;
  SectionBinRange bins = {};  ///< the bins that it touches, of which nothing is known
};

/// The answer to a table of outlines: stopped where any row is stopped, otherwise unknown where a
/// row is or where there is a gap. Its places are those of all rows, ascending by bin.
struct OutlineTableCheck : SectionCheck {
  std::vector<OutlineRowCheck> rows = {};  ///< of each row of the table, in its order
  std::vector<OutlineGap> gaps = {};       ///< where the load has a pose, in the order of the path
};

/// The whole cells of a window: columns j_from .. j_to - 1 and rows k_from .. k_to - 1.
struct SectionGrid {
  std::int32_t j_from = 0, j_to = 0, k_from = 0, k_to = 0;
};

/// A section in a file.
class Section {
 public:
  /// Throws InputError where the file is not an intact section, and ResourceError where it cannot
  /// be read.
  explicit Section(const std::filesystem::path& path);
  explicit Section(SectionData data);

  const SectionData& data() const { return data_; }
  SectionGrid grid() const;  ///< the cells of the window
  /// The file that was read; empty for a section that was made of its data.
  const std::filesystem::path& path() const { return path_; }
  const SectionCells& cells() const { return cells_; }  ///< blocked cells of the whole path
  /// The cells of the whole path that are not known; empty without seen space.
  const SectionCells& unknown_cells() const { return unknown_; }

  /// Whether a load with this outline, and with the length for which the section was found, passes
  /// at a distance of more than `margin` from every point; none: the margin for which the section
  /// was found. bins: only these are judged. Throws UsageError for a margin that is negative or not
  /// finite, and for an outline that outline_model() refuses.
  SectionCheck check(std::span<const OutlinePoint> outline, std::optional<double> margin = {},
                     SectionBinRange bins = {}) const;

  /// Judges each row of a table by the bins that it touches, with its own outline and margin, and
  /// without one with `margin`. A bin of which a part has no outline is unknown. station: of each
  /// pose of the path, for a table by stations. Throws as check() does, with file and line, and
  /// UsageError where stations are missing or do not ascend.
  OutlineTableCheck check(const OutlineTable& table, std::optional<double> margin = {},
                          std::span<const double> station = {}) const;

  /// For each cell of grid(), row by row, whether it is free with this margin, or without one with
  /// that of the section; false everywhere where the section is in doubt or the margin exceeds that
  /// of the section.
  std::vector<bool> free_cells(std::optional<double> margin = {}) const;

 private:
  SectionData data_;
  SectionCells cells_, unknown_;
  SectionCells ever_unknown_;  ///< the cells that are not known in any bin, blocked before or not
  std::filesystem::path path_;
};

/// The point of the environment that blocks a cell.
struct SectionWitness {
  std::uint64_t source = 0;      ///< source index of the point
  Vec3 xyz{};                    ///< its position
  std::uint8_t point_class = 0;  ///< its class; 0 where the environment has no classes
};

/// A cell, and a pose of the path that blocks it.
struct SectionPlace {
  std::uint32_t pose = 0;
  std::array<std::int32_t, 2> cell{};  ///< j, k
};

/// The point with the least source index that lies in each of these cells at its pose, found by a
/// search of these poses over the store; none where no point does. store and path are those of the
/// section. Throws InputError where they are not, or where the store is damaged.
std::vector<std::optional<SectionWitness>> section_witnesses(const SectionData& section,
                                                             const Store& store,
                                                             const std::vector<Pose>& path,
                                                             std::span<const SectionPlace> places);

/// The tables of a section.
enum class SectionTable {
  kBands,
  kStations,
  kBoxes,
  kCells,
  kBinCells,
  kUnknownCells,    ///< cells of the whole path that are not known; only with seen space
  kUnknownBinCells  ///< those of each bin
};

/// "bands", "stations", "boxes", "cells", "bin-cells", "unknown-cells" or "unknown-bin-cells".
const char* name_of(SectionTable table);

/// The heights for which widths are listed.
struct SectionHeights {
  double band = 0;  ///< height of a band; 0: 0.1 m
  /// Where the first band begins, in the window; none: 0, or the bottom of a window without z = 0,
  /// and for boxes and the largest load the lowest band whose middle is free
  std::optional<double> base = {};
};

/// Writes a table of a section as CSV. With seen space, tables of widths have two more columns,
/// which say whether a width ends at a blocked cell or at one that is not known. Throws UsageError
/// where the table needs the middle, y = 0, and the window lacks it, where it needs seen space, for
/// widths of a section in doubt, for a band that is not above 0, for a base below the window, and
/// for an output that exists.
void export_section(const Section& section, SectionTable table, const std::filesystem::path& output,
                    const SectionHeights& heights = {}, bool overwrite = false);

/// Writes the outline of the largest load as a closed polyline in a DXF file: for each band its
/// widths to the left and to the right, narrower by more than the section's rounding. The drawing
/// looks forward: its x is to the right, which is -y of the load, and its y is up. Open sides end
/// at the window. Throws as export_section() does, and UsageError where no load stands on the base.
void export_section_outline(const Section& section, const std::filesystem::path& output,
                            const SectionHeights& heights = {}, bool overwrite = false);

}  // namespace clearway
