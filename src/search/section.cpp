#include "search/section.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "clearway/error.hpp"
#include "core/geometry/rigid.hpp"
#include "core/messages/messages.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "core/util/stopwatch.hpp"
#include "findings/check_conflicts.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/thread_limit.hpp"
#include "io/paths/content_hash.hpp"
#include "io/section/section_file.hpp"
#include "io/store/store_reader.hpp"
#include "search/block_cells.hpp"
#include "search/check_corridor.hpp"
#include "search/check_query.hpp"
#include "search/checks/query_warnings.hpp"
#include "search/checks/question.hpp"
#include "search/ignored.hpp"
#include "search/section_ignored.hpp"
#include "search/section_seen.hpp"
#include "search/seen_space.hpp"

namespace clearway {

void add_cells_of_bin(const SectionLattice& lattice, std::span<const std::uint32_t> firsts,
                      std::uint32_t number, SectionCells& cells,
                      std::span<const std::uint32_t> without) {
  const auto j0 = static_cast<std::int32_t>(lattice.j_from);
  const auto k0 = static_cast<std::int32_t>(lattice.k_from);
  for (std::size_t cell = 0; cell < firsts.size(); ++cell) {
    if (firsts[cell] == kNotBlocked) continue;
    if (!without.empty() && firsts[cell] == without[cell]) continue;
    cells.bin.push_back(number);
    cells.j.push_back(j0 + static_cast<std::int32_t>(cell % lattice.columns));
    cells.k.push_back(k0 + static_cast<std::int32_t>(cell / lattice.columns));
    cells.first_pose.push_back(firsts[cell]);
  }
}

Body load_of_section(const std::vector<Pose>& path, const SectionParameters& parameters,
                     std::vector<Message>* doubts) {
  if (parameters.pivots && !path.empty()) {
    return follow({"load", {}, {}, {}}, path, *parameters.pivots, doubts);
  }
  Body load;
  load.poses = path;
  load.path_pose.resize(path.size());
  for (std::uint32_t i = 0; i < path.size(); ++i) load.path_pose[i] = i;
  return load;
}

QueryParameters ignored_by(const SectionParameters& asked) {
  QueryParameters query;
  query.ignore_classes = asked.ignore_classes;
  query.ignore_boxes = asked.ignore_boxes;
  return query;
}

namespace {

SectionParameters with_defaults(SectionParameters asked, double metre) {
  if (!asked.window) asked.window = SectionWindow{-4 * metre, 4 * metre, 0, 6 * metre};
  if (asked.cell == 0) asked.cell = 0.02 * metre;
  if (asked.bin == 0) asked.bin = 5 * metre;
  if (asked.seen && asked.seen_cube == 0) asked.seen_cube = 0.2 * metre;
  QueryParameters ignored;
  ignored.ignore_classes = std::move(asked.ignore_classes);
  ignored.ignore_boxes = std::move(asked.ignore_boxes);
  sort_ignored(ignored);
  asked.ignore_classes = std::move(ignored.ignore_classes);
  asked.ignore_boxes = std::move(ignored.ignore_boxes);
  return asked;
}

/// Throws UsageError for poses whose inverse would change lengths.
void check_rigid(std::span<const Pose> poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Stretch stretch = stretch_of(poses[i]);
    const bool finite = std::ranges::all_of(poses[i].translation,
                                            [](double value) { return std::isfinite(value); });
    if (finite && stretch.least >= 1 - kRigidTolerance && stretch.greatest <= 1 + kRigidTolerance) {
      continue;
    }
    throw UsageError("pose " + std::to_string(i) + " stretches lengths by " +
                     format_brief(stretch.least) + " to " + format_brief(stretch.greatest) +
                     "; a section is measured in the frame of the load, so expected rotations "
                     "whose singular values are within 1e-4 of 1, and finite positions");
  }
}

/// One call of find_section(), step by step.
class Finder {
 public:
  Finder(const Store& store, const std::vector<Pose>& path, const SectionParameters& parameters,
         const std::filesystem::path& output, const SectionOptions& options)
      : store_(store.reader()),
        unit_name_(store.length_unit()),
        path_(path),
        options_(options),
        progress_(options_.progress, options_.stop),
        log_(options_.message, data_.warnings),
        pending_(output, options.overwrite),
        device_(store, options_, log_) {
    data_.parameters = with_defaults(parameters, metre_of(store_));
  }

  SectionReport run() {
    section_lattice(data_.parameters, 0);  // refuses what is asked before anything is computed
    if (data_.parameters.seen) check_cubes();
    if (!data_.parameters.seen && data_.parameters.seen_cube != 0) {
      throw UsageError("a cube of seen space: expected seen space to be asked for");
    }
    check_rigid(path_);
    place_load();
    CorridorCheck(store_.metadata()).check(data_.parameters, load_);
    describe();
    warn();
    if (options_.strict) refuse_warnings(data_.warnings);
    const Stopwatch searching;
    if (!load_.poses.empty()) find();
    report_.search_seconds =
        searching.seconds() - report_.engine_seconds - report_.context_wait_seconds;
    publish();
    report_.seconds = total_.seconds();
    return std::move(report_);
  }

 private:
  /// The poses of the load, and the poses of the path that they belong to.
  void place_load() {
    for (const Message& message : options_.input_warnings) {
      if (message.severity == Message::Severity::kWarning) data_.warnings.push_back(message);
    }
    std::vector<Message> doubts;
    load_ = load_of_section(path_, data_.parameters, &doubts);
    for (Message& doubt : doubts) log_.add(std::move(doubt));
    if (data_.parameters.pivots) check_rigid(load_.poses);
    if (!data_.parameters.between_poses) return;
    for (std::size_t i = 1; i < load_.path_pose.size(); ++i) {
      if (load_.path_pose[i] == load_.path_pose[i - 1] + 1) continue;
      throw UsageError("the load has no pose between poses " +
                       std::to_string(load_.path_pose[i - 1]) + " and " +
                       std::to_string(load_.path_pose[i]) +
                       " of the path, so that its way there is not known: search at poses, or "
                       "split the path");
    }
  }

  void describe() {
    if (path_.size() >= kNotBlocked) throw UsageError("a path of 2^32 poses or more");
    SectionMotion motion;
    if (data_.parameters.between_poses) {
      motion = section_motion(load_.poses, data_.parameters);
      data_.motion = {motion.along, motion.across};
    }
    lattice_ = section_lattice(data_.parameters, motion.along);
    data_.rounding =
        section_rounding(largest_coordinate(store_), load_.poses, data_.parameters, lattice_);
    data_.environment_points = store_.point_count();
    data_.poses = path_.size();
    data_.load_poses = load_.poses.size();
    data_.crs_wkt = store_.metadata().crs_wkt;
    data_.length_unit = unit_name_;
    data_.chainage = chainage_of(path_);
    data_.environment_hash = store_.metadata().points_hash;
    data_.trajectory_hash = hash_of_trajectory(path_);
  }

  /// Throws UsageError where the store cannot have seen space.
  void check_cubes() const {
    QueryParameters seen;
    seen.seen = true;
    seen.seen_cube = data_.parameters.seen_cube;
    if (!(std::isfinite(seen.seen_cube) && seen.seen_cube > 0)) {
      throw UsageError("cubes of seen space of " + format_number(seen.seen_cube) +
                       "; expected sides of a length above 0");
    }
    check_seen_space(store_, seen);
  }

  /// Warns of what the section may have misread. Nothing of it changes the section.
  void warn() {
    const IgnoredPointCounts ignored =
        count_ignored(store_, ignored_by(data_.parameters), options_.threads);
    data_.ignored_points = ignored.points;
    if (ignored_by(data_.parameters).ignores_points()) data_.ignored_cells.emplace();
    in_threads(options_.threads, [&] {
      warn_of_section(store_, data_.parameters, ignored, load_, data_.chainage,
                      options_.input_warnings, log_);
    });
  }

  /// Bytes that writing the cells takes: those of one bin at a time, and which are in any bin.
  std::uint64_t bytes_to_write() const {
    constexpr std::uint64_t kCellBytes = 4 * sizeof(std::uint32_t), kChunkBytes = 1 << 18;
    return lattice_.cells() * kCellBytes + lattice_.cells() / 8 + kChunkBytes;
  }

  /// Throws ResourceError where the maps do not fit the memory.
  void check_memory(std::size_t bins, std::uint64_t of_cubes) {
    const std::uint64_t of_map = SectionMaps::bytes_of_bin(lattice_);
    const bool two_maps = data_.parameters.seen || data_.ignored_points > 0;
    const std::uint64_t of_bin = two_maps ? 2 * of_map : of_map;
    const std::uint64_t fixed =
        store_.allocated_bytes() + 2 * path_.size() * (sizeof(Pose) + sizeof(double)) +
        2 * (load_.poses.size() + bins) * sizeof(SectionPoseNode) + bytes_to_write() + of_cubes;
    report_.needed_host_bytes = fixed + bins * of_bin;
    if (report_.needed_host_bytes <= options_.memory_bytes) return;
    const std::string sizes = "a section of " + counted(bins, "bin") + " of " +
                              format_brief(data_.parameters.bin) + " with " +
                              format_count(lattice_.cells()) + " cells each takes " +
                              format_size(report_.needed_host_bytes) + " of memory, and " +
                              format_size(options_.memory_bytes) + " are allowed";
    throw ResourceError(sizes + coarser_bin(fixed, of_bin), Remedy::kMoreMemory,
                        static_cast<double>(report_.needed_host_bytes));
  }

  /// A sentence with a length of bins of which so few are needed that they fit the memory.
  std::string coarser_bin(std::uint64_t fixed, std::uint64_t of_bin) const {
    const std::uint64_t most =
        options_.memory_bytes > fixed ? (options_.memory_bytes - fixed) / of_bin : 0;
    if (most == 0) return "; larger cells or a smaller window take less";
    SectionParameters coarser = data_.parameters;
    coarser.bin =
        std::ceil(std::max(coarser.bin, data_.chainage.back() / static_cast<double>(most)));
    while (section_bins(data_.chainage, load_.path_pose, coarser).size() > most) {
      coarser.bin = std::ceil(coarser.bin * 1.01);
    }
    return "; bins of " + format_number(coarser.bin) + " fit";
  }

  void find() {
    const std::vector<SectionBin> bins =
        section_bins(data_.chainage, load_.path_pose, data_.parameters);
    const SectionPoses poses(load_.poses, load_.path_pose, bins);
    std::optional<SectionSeen> seen;
    if (data_.parameters.seen) {
      seen.emplace(store_, data_.parameters, load_.poses, poses, lattice_, data_.rounding,
                   options_.memory_bytes / 4);
    }
    check_memory(bins.size(), seen ? seen->needed_bytes() : 0);
    bytes_of_maps_ = report_.needed_host_bytes;
    maps_.emplace(lattice_, bins.size());
    const IgnoredPoints ignored(store_, ignored_by(data_.parameters));
    device_.block(store_, ignored, section_ref(poses, lattice_, data_.rounding, *maps_),
                  options_.memory_bytes - report_.needed_host_bytes, progress_, report_);
    for (const SectionBin& bin : bins) {
      data_.bins.push_back(static_cast<std::uint32_t>(bin.number));
    }
    count_blocked();
    if (data_.ignored_cells && data_.ignored_points > 0) find_ignored(poses, bins);
    if (seen) find_unknown(*seen);
  }

  /// A second search, of the ignored points alone, for the cells that only they block.
  void find_ignored(const SectionPoses& poses, std::span<const SectionBin> bins) {
    const IgnoredPoints ignored(store_, ignored_by(data_.parameters),
                                IgnoredPoints::Search::kIgnored);
    SectionMaps maps(lattice_, bins.size());
    SectionReport taken;
    device_.block(store_, ignored, section_ref(poses, lattice_, data_.rounding, maps),
                  options_.memory_bytes - bytes_of_maps_, progress_, taken);
    report_.needed_host_bytes =
        std::max(report_.needed_host_bytes, bytes_of_maps_ + taken.needed_host_bytes);
    report_.peak_device_bytes = std::max(report_.peak_device_bytes, taken.peak_device_bytes);
    report_.engine_seconds += taken.engine_seconds;
    report_.context_wait_seconds += taken.context_wait_seconds;
    const LengthUnit unit = store_.metadata().unit;
    const CellsOfIgnored found =
        cells_of_ignored(*maps_, maps, lattice_, bins, load_.path_pose, ground_height(unit));
    data_.ignored_cells = found;
    warn_of_cells_of_ignored(data_, found, report_.blocked, unit, log_);
    if (options_.strict) refuse_warnings(data_.warnings);
  }

  /// Blocks a copy of the maps by the cubes that no beam saw, too: cells whose first pose falls are
  /// not known.
  void find_unknown(const SectionSeen& seen) {
    taken_ = maps_;
    warn_of_beams(seen.block(options_.threads, *taken_, progress_), log_);
    if (options_.strict) refuse_warnings(data_.warnings);
    unknown_.emplace();
    for (std::size_t bin = 0; bin < data_.bins.size(); ++bin) {
      const std::span blocked = maps_->firsts(bin);
      unknown_->counts.push_back(
          std::transform_reduce(blocked.begin(), blocked.end(), taken_->firsts(bin).begin(),
                                std::uint64_t{0}, std::plus<>(), std::not_equal_to<>()));
    }
    unknown_->add = [this](std::size_t bin, SectionCells& cells) {
      cells.reserve(unknown_->counts[bin]);
      add_cells_of_bin(lattice_, taken_->firsts(bin), data_.bins[bin], cells, maps_->firsts(bin));
    };
    report_.seen =
        SectionSeenCounts{data_.parameters.seen_cube, count_unknown_anywhere(), unknown_->total()};
  }

  /// How many cells of the whole path are not known, and not blocked at that pose or before.
  std::uint64_t count_unknown_anywhere() const {
    std::uint64_t count = 0;
    for (std::uint64_t cell = 0; cell < lattice_.cells(); ++cell) {
      std::uint32_t blocked = kNotBlocked, unknown = kNotBlocked;
      for (std::size_t bin = 0; bin < data_.bins.size(); ++bin) {
        const std::uint32_t first = maps_->firsts(bin)[cell], taken = taken_->firsts(bin)[cell];
        blocked = std::min(blocked, first);
        if (taken != first) unknown = std::min(unknown, taken);
      }
      if (unknown < blocked) ++count;
    }
    return count;
  }

  /// Counts the blocked cells of each bin, and those of the whole path.
  void count_blocked() {
    const auto blocked_in = [](std::uint32_t first) { return first != kNotBlocked; };
    for (std::size_t bin = 0; bin < data_.bins.size(); ++bin) {
      blocked_.counts.push_back(
          static_cast<std::uint64_t>(std::ranges::count_if(maps_->firsts(bin), blocked_in)));
    }
    report_.blocked = static_cast<std::uint64_t>(
        std::ranges::count(maps_->blocked_anywhere(data_.bins.size()), true));
    blocked_.add = [this](std::size_t bin, SectionCells& cells) {
      cells.reserve(blocked_.counts[bin]);
      add_cells_of_bin(lattice_, maps_->firsts(bin), data_.bins[bin], cells);
    };
  }

  void publish() {
    report_.blocked_in_bins = blocked_.total();
    report_.bins = data_.bins.size();
    if (report_.blocked == 0 && data_.environment_points > data_.ignored_points &&
        !load_.poses.empty()) {
      log_.warn("nothing-blocked",
                "no point blocks a cell of the window: it is free, or nothing was scanned where "
                "the load passes");
      if (options_.strict) refuse_warnings(data_.warnings);
    }
    if (data_.parameters.seen && !unknown_) {  // a path without poses
      unknown_.emplace();
      report_.seen = SectionSeenCounts{data_.parameters.seen_cube, 0, 0};
    }
    report_.rounding = data_.rounding;
    report_.ignored_points = data_.ignored_points;
    report_.ignored_cells = data_.ignored_cells;
    report_.motion = data_.motion;
    report_.warnings = data_.warnings;
    write_section(data_, blocked_, unknown_, pending_.partial());
    store_.check_read();
    pending_.publish();
  }

  const StoreReader& store_;
  const std::string unit_name_;
  const std::vector<Pose>& path_;
  const SectionOptions options_;
  CallbackProgress progress_;
  SectionData data_;
  MessageLog log_;
  PendingFile pending_;
  SectionDevice device_;
  Body load_;
  SectionLattice lattice_{};
  std::uint64_t bytes_of_maps_ = 0;   ///< memory that is taken besides that of a device
  std::optional<SectionMaps> maps_;   ///< blocked cells
  std::optional<SectionMaps> taken_;  ///< with seen space: blocked cells and those not known
  SectionRows blocked_;
  std::optional<SectionRows> unknown_;
  SectionReport report_;
  Stopwatch total_;
};

}  // namespace

SectionReport find_section(const Store& store, const std::vector<Pose>& path,
                           const SectionParameters& parameters, const std::filesystem::path& output,
                           const SectionOptions& options) {
  refuse_overwriting(output, {store.path()});
  return Finder(store, path, parameters, output, options).run();
}

}  // namespace clearway
