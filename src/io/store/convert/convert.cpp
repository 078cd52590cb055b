#include "io/store/convert/convert.hpp"

#include <tbb/parallel_pipeline.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <future>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/convert.hpp"
#include "clearway/error.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/util/format.hpp"
#include "core/util/progress.hpp"
#include "core/util/shortened.hpp"
#include "core/util/stopwatch.hpp"
#include "core/util/threads.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/files/file.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/thread_limit.hpp"
#include "io/result/journal_values.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/point_formats.hpp"
#include "io/scans/point_reader.hpp"
#include "io/store/convert/conversion_identity.hpp"
#include "io/store/convert/conversion_journal.hpp"
#include "io/store/convert/count.hpp"
#include "io/store/convert/distribute.hpp"
#include "io/store/convert/environment_source.hpp"
#include "io/store/convert/input_agreement.hpp"
#include "io/store/convert/input_files.hpp"
#include "io/store/convert/input_warnings.hpp"
#include "io/store/convert/map_warnings.hpp"
#include "io/store/convert/near_path.hpp"
#include "io/store/convert/origin_table.hpp"
#include "io/store/convert/pack_unit.hpp"
#include "io/store/convert/path_origins.hpp"
#include "io/store/convert/quantum_bounds.hpp"
#include "io/store/convert/read_points.hpp"
#include "io/store/convert/source_description.hpp"
#include "io/store/convert/split_tree.hpp"
#include "io/store/convert/stage_clocks.hpp"
#include "io/store/convert/withheld_cubes.hpp"
#include "io/store/store_metadata.hpp"
#include "io/store/store_reader.hpp"
#include "io/store/store_writer.hpp"
#include "io/store/verify_store.hpp"

namespace clearway {
namespace {

/// A unit before it is written: its first cells are packed already, the others are packed when they
/// are written.
struct UnitInFlight {
  std::vector<PackedCell> packed;
  std::optional<OrderedUnit> rest;
};

void write_unit(UnitInFlight& unit, StoreWriter& writer, StageClocks& clocks, Progress& progress) {
  while (!unit.packed.empty()) {
    for (const PackedCell& cell : unit.packed) {
      throw_if_stopped(progress);
      const auto running = clocks.measure(Stage::kWrite);
      writer.append(cell);
      progress.advance(cell.cell.count);
    }
    unit.packed.clear();
    if (unit.rest) unit.packed = unit.rest->pack_next();
  }
}

/// Partitions and packs the units, several at a time as memory allows, and writes their cells in
/// order.
void write_cells(Distribution& distribution, const SplitTree& tree, const Lattice& lattice,
                 const StoreMetadata& metadata, const OriginTable* origins,
                 std::size_t units_in_flight, StoreWriter& writer, StageClocks& clocks,
                 Progress& progress) {
  progress.begin("partition", metadata.point_count, "points");
  std::size_t next = 0;
  std::size_t largest = 0;
  for (std::size_t unit = 0; unit < distribution.units(); ++unit) {
    largest = std::max<std::size_t>(largest, distribution.points(unit));
  }
  UnitBuffers buffers(largest);
  using Flying = std::shared_ptr<UnitInFlight>;
  const ParallelScope scope;
  const SerialStage input, output;
  const auto number_of_next = piece_of(scope, input, [&](tbb::flow_control& flow) {
    throw_if_stopped(progress);
    if (next == tree.units().size()) flow.stop();
    return next++;
  });
  const auto order_and_pack = piece_of(scope, [&](std::size_t unit) {
    auto flying = std::make_shared<UnitInFlight>();
    flying->rest.emplace(distribution, unit, tree, lattice, metadata, origins, buffers, clocks);
    flying->packed = flying->rest->pack_next();
    if (flying->rest->cells_left() == 0) flying->rest.reset();
    return flying;
  });
  const auto write = piece_of(
      scope, output, [&](const Flying& unit) { write_unit(*unit, writer, clocks, progress); });
  scope.begin();
  tbb::parallel_pipeline(
      units_in_flight,
      tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, number_of_next) &
          tbb::make_filter<std::size_t, Handed<Flying>>(tbb::filter_mode::parallel,
                                                        order_and_pack) &
          tbb::make_filter<Handed<Flying>, void>(tbb::filter_mode::serial_in_order, write));
  progress.end();
}

/// Takes the facts of a conversion that the description of its store has.
void take_facts(const StoreMetadata& metadata, ConvertReport& report) {
  const auto& [scale, offset] = metadata.quantisation;
  report.points = metadata.point_count;
  report.scale = {scale[0], scale[1], scale[2]};
  report.offset = {offset[0], offset[1], offset[2]};
  const StoreWithheld withheld = metadata.withheld.value_or(StoreWithheld());
  report.withheld_points = withheld.left_out();
  report.kept_withheld_points = withheld.points - withheld.left_out();
  report.origins = metadata.origins ? metadata.origins->quanta.size() : 0;
  report.points_without_origin =
      metadata.origins ? metadata.origins->points_without : metadata.point_count;
  if (!metadata.near) return;
  report.far_points = metadata.near->left_out;
  report.unread_points = metadata.near->unread;
  report.passed_over_files = metadata.near->passed_over;
}

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
constexpr std::uint64_t kBaseBytes = 64 * kMiB;  // memory of batches, index and libraries
// Memory per thread: a counting grid and its refinement.
constexpr std::uint64_t kThreadBytes = 32 * kMiB;
constexpr std::uint64_t kCellBytes = 180;           // index and tree nodes of a cell
constexpr std::uint64_t kColumnCellBytes = 20;      // index of classes or origins, of a cell
constexpr std::uint64_t kOutputBytesPerPoint = 11;  // an estimate for the disk check
constexpr std::uint64_t kPaddingBytesPerPoint = 4;  // an estimate for the disk check
constexpr std::uint32_t kLeastCellPoints = 64;

void check_columns(const std::vector<std::string>& columns) {
  if (columns.empty()) return;
  const auto is_wrong = [](const std::string& column) {
    return column.empty() || column.find_first_not_of('0') == std::string::npos;
  };
  if (columns.size() != 3 || std::any_of(columns.begin(), columns.end(), is_wrong) ||
      columns[0] == columns[1] || columns[0] == columns[2] || columns[1] == columns[2]) {
    throw UsageError("expected three different columns, of x, y and z: numbers from 1, or names");
  }
}

void check_origins(const ConversionOptions& options) {
  if (!options.origins.empty() && !options.origins_path.empty()) {
    throw UsageError("origins are given by a file and by a path; expected one of the two");
  }
  const Vec3& arm = options.lever_arm;
  if (!is_finite(arm)) throw UsageError("a lever arm: expected three finite lengths");
  if (options.origins_path.empty() && !(arm == Vec3{0, 0, 0})) {
    throw UsageError("a lever arm belongs to a path of origins, and none is given");
  }
}

void check_corridor(const ConversionOptions& options) {
  if (options.near.empty()) {
    if (options.within == 0 && !options.trust_bounds) return;
    throw UsageError("a distance from a path, or trust in bounds: expected the path");
  }
  if (!(options.within > 0) || !std::isfinite(options.within)) {
    throw UsageError("points near a path are to be kept: expected the distance, in metres above 0");
  }
}

void check_options(const ConversionOptions& options) {
  if (options.memory_bytes < kLeastConversionMemory) {
    throw ResourceError(format_size(options.memory_bytes) +
                            " of memory is too little: a conversion needs at least " +
                            format_size(kLeastConversionMemory),
                        Remedy::kMoreMemory, static_cast<double>(kLeastConversionMemory));
  }
  if (options.cell_points < kLeastCellPoints || options.cell_points > kMostCellPoints) {
    throw UsageError(std::to_string(options.cell_points) + " points a cell: expected " +
                     std::to_string(kLeastCellPoints) + " to " + std::to_string(kMostCellPoints));
  }
  if (options.regular_size && !(*options.regular_size > 0)) {
    throw UsageError("a regular layout: expected cubes of a positive length");
  }
  if (options.scale && !(*options.scale > 0 && std::isfinite(*options.scale))) {
    throw UsageError("a scale of " + format_digits(*options.scale, 9) +
                     ": expected a positive length");
  }
  check_columns(options.columns);
  check_origins(options);
  check_corridor(options);
}

/// The number of threads that the memory allows, as each has a counting grid of its own.
int affordable_threads(const ConversionOptions& options) {
  const int wanted = threads_or_all(options.threads);
  const std::uint64_t affordable = (options.memory_bytes - kBaseBytes) / kThreadBytes;
  return static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(wanted), affordable));
}

Lattice lattice_for(const ConversionOptions& options, const Quantisation& quantisation) {
  if (!options.regular_size) return {};
  std::array<std::uint64_t, 3> cube{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double quanta = std::nearbyint(*options.regular_size / quantisation.scale[k]);
    if (!(quanta >= Lattice::kLeastCubeQuanta && quanta <= 0x1p32)) {
      throw UsageError("a regular layout: expected cubes of " +
                       std::to_string(Lattice::kLeastCubeQuanta) + " to 2^32 times the scale");
    }
    cube[k] = static_cast<std::uint64_t>(quanta);
  }
  return Lattice(cube);
}

/// The amount of data that a conversion writes, in points.
struct DiskNeed {
  std::uint64_t points = 0;
  /// Points including the padding of cells that are not full, which packs to less.
  std::uint64_t padded = 0;
  std::uint64_t spooled = 0;  ///< points that are written into temporary files
};

std::uint64_t bytes_of(const DiskNeed& need) {
  return need.points * kOutputBytesPerPoint + (need.padded - need.points) * kPaddingBytesPerPoint +
         need.spooled * sizeof(DistributedPoint);
}

void check_disk(const std::filesystem::path& folder, const DiskNeed& need) {
  const std::uint64_t needed = bytes_of(need);
  const std::uint64_t free = free_disk_bytes(folder);
  if (needed <= free) return;
  const bool mostly_padding = need.padded > 2 * need.points;
  throw ResourceError(folder.string() + ": " + std::to_string(free / kMiB) +
                          " MiB free, expected about " + std::to_string(needed / kMiB) +
                          " MiB for " + (need.spooled > 0 ? "the temporary files and " : "") +
                          "the store of " + std::to_string(need.points) + " points" +
                          (mostly_padding ? "; most of it pads cells that are not full" : ""),
                      mostly_padding ? Remedy::kFewerCellPoints : Remedy::kFreeDisk);
}

/// The memory limit of the process's control group, such as a container's; the greatest number
/// where there is no limit.
std::uint64_t group_memory_bytes() {
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
  for (const char* file :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::uint64_t bytes = 0;
    if (std::ifstream(file) >> bytes) least = std::min(least, bytes);
  }
  return least;
}

/// The most bytes of points that may wait in memory: half of the machine's or the container's,
/// because inputs and store need the rest.
std::uint64_t most_waiting_bytes() {
  const std::uint64_t of_machine = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                                   static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return std::min(of_machine, group_memory_bytes()) / 2;
}

class Conversion {
 public:
  Conversion(const ConversionOptions& options, int threads, Progress& progress)
      : options_(options),
        threads_(threads),
        progress_(progress),
        folder_(folder_of(options.output)),
        output_(options.output, options.overwrite || options.resume),
        options_text_(store_options(options)),
        withheld_(options.memory_bytes / 8) {}

  ConversionReport run() {
    // Standard input can be read only once, so that there is nothing to go on with.
    if (std::ranges::find(options_.inputs, "-") != options_.inputs.end()) {
      give_way_to_stream(output_, options_);
      if (!options_.overwrite) output_.refuse_existing();
      return convert();
    }
    journal_.emplace(output_, options_, log_);
    if (!journal_->replaces()) output_.refuse_existing();
    try {
      return convert();
    } catch (const InputError&) {
      journal_->discard();  // the inputs have to change
      throw;
    } catch (const UsageError&) {
      journal_->discard();  // the options have to change
      throw;
    } catch (const ResourceError& error) {
      const Remedy remedy = error.remedy();
      const bool needs_other_cells =
          remedy == Remedy::kMoreCellPoints || remedy == Remedy::kFewerCellPoints;
      if (needs_other_cells && !journal_->resumes()) {  // memory or disk sufficed before
        journal_->discard();
      } else {
        journal_->leave();
      }
      throw;
    } catch (...) {
      journal_->leave();
      throw;
    }
  }

 private:
  ConversionReport convert() {
    FoundInputs found;
    const bool were_found = take(ConversionPhase::kInspected, found);
    EnvironmentSource environment(options_, progress_, were_found ? &found : nullptr);
    found = environment.found();
    const bool were_read = found.chosen || !found.readable.skipped.empty();
    if (journal_ && were_read && !were_found) keep(ConversionPhase::kInspected, found);
    refuse_overwriting(options_.output, environment.read_files());
    for (const auto& given : {options_.origins, options_.origins_path, options_.near}) {
      if (!given.empty()) refuse_overwriting(options_.output, {given});
    }
    if (environment.declared_points()) {
      check_disk(folder_, {*environment.declared_points(), *environment.declared_points()});
    }
    std::optional<Corridor> corridor;
    if (!options_.near.empty()) {
      corridor.emplace(corridor_of(options_, environment.crs().crs, environment.unit(), log_));
      environment.keep_near(*corridor, options_.trust_bounds);
    }
    OriginTable origins(environment.quantisation(), options_.memory_bytes / 4);
    const Lattice lattice = lattice_for(options_, environment.quantisation());
    Counted all;
    if (!take_counted(environment, origins, all)) count(environment, lattice, origins, all);
    CountedEnvironment& counted = all.environment;
    fill_metadata(environment, counted, std::move(all.sources));
    for (const Message& message : all.of_path) log_.add(message);
    const bool names_no_unit =
        environment.unit() == LengthUnit::kUnknown && !environment.crs().is_partly_read;
    if (names_no_unit && counted.points > 0) {
      log_.note(
          "the inputs name no unit of length, so metres are assumed; --unit names another one");
    }
    report_.box = warn_of_inputs(environment, all.boxes, report_.metadata, log_);
    if (corridor) describe_corridor(environment, *corridor);
    check_coordinates(environment, all.boxes);
    for (const Message& message : all.of_places) log_.add(message);
    report_.origins_path = std::move(all.origins_path);
    if (origins.any()) origins_ = &origins;
    const SplitTree tree(counted.bins, lattice, environment.quantisation().scale);
    const std::vector<TopNode> top = tree.top_nodes(options_.cell_points);
    check_cells(top, tree.units().size());
    report_.count_seconds = watch_.lap();

    const double metres = metres_of(environment.unit());
    PlaceCounter places(all.suspects, StepJudge(all.steps, environment.quantisation(),
                                                metres > 0 ? 1 / metres : 1));
    Distribution distribution(tree, point_files(tree.units().size()),
                              journal_ ? ConversionJournal::kPointsBegin : 0);
    if (!take_distributed(distribution, places)) {
      progress_.begin("distribute", counted.points, "points");
      distribute(environment, counted, lattice, tree, places, distribution, threads_, clocks_,
                 progress_, origins_, &withheld_);
      progress_.end();
      environment.refuse_changed();  // so that the sources' hashes are those of what was converted
      keep_distributed(environment, distribution, places);
    }
    report_.temporary_bytes = distribution.temporary_bytes();
    warn_of_places(environment, places, counted.points, log_);
    record_steps(places.steps());
    record_origins();
    if (options_.strict) refuse_warnings(report_.warnings);
    report_.metadata.warnings = kept_warnings(report_.warnings);
    report_.distribute_seconds = watch_.lap();
    write_store(distribution, tree, top, lattice);
    return std::move(report_);
  }

  /// What is known once all points were counted.
  struct Counted {
    CountedEnvironment environment;
    std::vector<SourceFile> sources;
    FileBoxes boxes;
    std::vector<PlaceQuanta> suspects;
    std::vector<InputSteps> steps;
    /// Remarks on the path of the origins, and on the points' places on it.
    std::vector<Message> of_path, of_places;
    std::optional<OriginsPathReport> origins_path;

    template <typename Values>
    void keep(Values& values) {
      values.add(environment, sources, boxes, suspects, steps, of_path, of_places);
      std::uint8_t has_path = origins_path ? 1 : 0;
      values.add(has_path);
      if (has_path == 0) return;
      if (!origins_path) origins_path.emplace();
      OriginsPathReport& path = *origins_path;
      values.add(path.point_clock, path.path_clock, path.first_point, path.last_point,
                 path.first_pose, path.last_pose, path.shifts, path.before, path.after,
                 path.in_gaps, path.without_time);
    }
  };

  /// Takes from the journal what an earlier process counted; returns false where it had not come to
  /// the end of it.
  bool take_counted(EnvironmentSource& environment, OriginTable& origins, Counted& all) {
    environment.rewind();
    if (!take(ConversionPhase::kCounted, all, origins, environment)) return false;
    environment.leave_out_times();
    return true;
  }

  void count(EnvironmentSource& environment, const Lattice& lattice, OriginTable& origins,
             Counted& all) {
    std::vector<Message> unused;
    if (!options_.origins.empty()) add_origins_of_file(options_.origins, origins);
    std::optional<PathOrigins> path;
    if (!options_.origins_path.empty()) {
      const MessageCallback collect = [&](const Message& message) {
        all.of_path.push_back(message);
      };
      MessageLog log(collect, unused);
      path.emplace(options_, environment, origins, log);
    }
    FileHashes hashes(environment.files(), environment.in_pieces());
    std::vector<bool> described = environment.in_pieces();
    for (std::size_t i = 0; i < environment.passed_over().size(); ++i) {
      if (!environment.passed_over()[i]) continue;
      hashes.pass_over(i);
      described[i] = true;
    }
    SourceDescription others(environment.read_files(), described, progress_);
    PlaceSample places(environment.quantisation());
    all.environment = count_environment(environment, lattice, places, all.boxes, hashes, threads_,
                                        clocks_, progress_, path ? &*path : nullptr);
    all.sources = others.get(hashes.finish());
    all.suspects = places.suspects();
    all.steps = find_steps(places.points(), environment.points_of_files());
    if (path && all.environment.points > 0) {
      const MessageCallback collect = [&](const Message& message) {
        all.of_places.push_back(message);
      };
      MessageLog log(collect, unused);
      all.origins_path = path->finish(log);
    }
    path.reset();
    collect_origins(environment, all.environment.input_points, origins);
    if (!journal_) return;
    environment.refuse_changed();  // so that nothing is kept of what is not in the files now
    keep(ConversionPhase::kCounted, all, origins, environment);
  }

  /// Takes values from the journal, in the order in which keep() put them there; returns false
  /// where no earlier process finished the phase.
  template <typename... Values>
  bool take(ConversionPhase phase, Values&... values) {
    const auto use = [&](JournalValues& from) { from.add(values...); };
    if (!journal_ || !journal_->take(phase, use)) return false;
    report_.resumed_from = in_words(phase);
    return true;
  }
  template <typename... Values>
  void keep(ConversionPhase phase, Values&... values) {
    journal_->keep(phase, [&](JournalValues& to) { to.add(values...); });
  }

  /// The files in which points wait; none where they wait in memory.
  std::vector<File> point_files(std::size_t units) {
    std::vector<File> files;
    if (in_memory_) return files;
    const std::size_t number = std::min(static_cast<std::size_t>(threads_), units);
    if (journal_) return journal_->open_points(number);
    for (std::size_t i = 0; i < number; ++i) files.push_back(File::create_temporary(folder_));
    return files;
  }

  /// Takes from the journal what an earlier process knew once all points were distributed; returns
  /// false where it had not come to that, or where the files of points do not hold them.
  bool take_distributed(Distribution& distribution, PlaceCounter& places) {
    std::vector<std::uint64_t> sums;
    if (in_memory_ || !take(ConversionPhase::kDistributed, sums)) return false;
    if (!distribution.take_over(sums)) {
      log_.note(
          "the temporary files do not hold the points that were written into them, so that the "
          "points are distributed again");
      report_.resumed_from = in_words(ConversionPhase::kCounted);
      return false;
    }
    std::vector<std::uint64_t> counts;
    std::vector<MetreCube> cubes;
    take(ConversionPhase::kDistributed, sums, places, counts, cubes, report_.largest_change);
    if (origins_ != nullptr) origins_->set_counts(counts);
    if (report_.metadata.withheld) report_.metadata.withheld->cubes = std::move(cubes);
    return true;
  }

  void keep_distributed(const EnvironmentSource& environment, const Distribution& distribution,
                        PlaceCounter& places) {
    std::vector<MetreCube> cubes = withheld_.take();
    report_.largest_change = environment.counts().largest_change;
    if (journal_ && !in_memory_) {
      std::vector<std::uint64_t> sums = distribution.sums(), counts;
      if (origins_ != nullptr) counts = origins_->counts();
      keep(ConversionPhase::kDistributed, sums, places, counts, cubes, report_.largest_change);
    }
    if (report_.metadata.withheld) report_.metadata.withheld->cubes = std::move(cubes);
  }

  /// Describes the corridor in the store, once all points were counted.
  void describe_corridor(const EnvironmentSource& environment, const Corridor& corridor) {
    const auto& counts = environment.counts();
    const auto& passed_over = environment.passed_over();
    if (report_.points == 0 && counts.far_points > 0) {
      refuse_empty_corridor(options_, corridor, report_.box, counts.far_points);
    }
    report_.metadata.near = {.path = {corridor.path().begin(), corridor.path().end()},
                             .within = corridor.within(),
                             .whole = report_.box.value_or(Box{}),
                             .left_out = counts.far_points,
                             .unread = counts.unread_points,
                             .unread_bytes = counts.unread_bytes,
                             .passed_over = static_cast<std::uint64_t>(
                                 std::count(passed_over.begin(), passed_over.end(), true))};
  }

  /// Judges the coordinates by the place where they lie, now that it is known.
  void check_coordinates(const EnvironmentSource& environment, const FileBoxes& boxes) {
    if (!report_.box) return;
    check_map_scales(environment, boxes.boxes(environment.files().size()), options_.ignore_crs,
                     log_);
    if (environment.unit() == LengthUnit::kUnknown) warn_of_degrees(*report_.box, log_);
  }

  void fill_metadata(const EnvironmentSource& environment, const CountedEnvironment& counted,
                     std::vector<SourceFile> sources) {
    report_.points = counted.points;
    report_.metadata = {.point_count = counted.points,
                        .input_points = counted.input_points,
                        .cell_points = options_.cell_points,
                        .quantisation = environment.quantisation(),
                        .layout = options_.regular_size
                                      ? "regular:" + format_number(*options_.regular_size)
                                      : "adaptive",
                        .options = options_text_,
                        .unit = environment.unit(),
                        .crs_wkt = environment.crs_wkt(),
                        .height_unit = environment.crs().height_unit,
                        .points_hash = counted.points_hash,
                        .sources = std::move(sources),
                        .source_points = {},
                        .classes = counted.classes};
    if (environment.files().size() > 1) {
      report_.metadata.source_points = environment.points_of_files();
      // Files of poses have 0 points.
      report_.metadata.source_points.resize(report_.metadata.sources.size());
    }
    const std::uint64_t withheld = environment.counts().withheld_points;
    if (withheld > 0) {
      report_.metadata.withheld = {.points = withheld, .kept = options_.keep_withheld};
    }
    for (const CloudInfo& info : environment.infos()) report_.metadata.dates.add(info.date);
    report_.absent_points = environment.counts().absent_points;
    report_.non_finite_points = environment.counts().non_finite_points;
  }

  /// Collects the origins of all points, now that the inputs have been read once.
  void collect_origins(const EnvironmentSource& environment, std::uint64_t input_points,
                       OriginTable& origins) {
    if (!options_.origins.empty()) {
      refuse_origins_beyond(options_.origins, input_points);
    } else if (options_.origins_path.empty()) {
      add_origins_of_inputs(environment, origins);
    }
    origins.finish();
  }

  /// Describes the steps of the coordinates in the store, and warns of coarse ones.
  void record_steps(const StepJudge& steps) {
    report_.metadata.steps = steps.rounded_to();
    if (auto lost = steps.warning_on_lost_digits(report_.metadata.unit)) log_.add(*lost);
  }

  /// Describes the origins in the store and warns of them, once all points were counted.
  void record_origins() {
    StoreMetadata& metadata = report_.metadata;
    if (origins_ != nullptr) metadata.origins = origins_->origins(report_.points);
    if (!metadata.origins) {
      origins_ = nullptr;
      return;
    }
    const double metres = metres_of(metadata.unit);
    origins_->warn(*metadata.origins, report_.points, report_.box, metres > 0 ? metres : 1, log_);
  }

  std::uint64_t of_unit() const {
    return unit_bytes(report_.metadata.classes.has_value(), origins_ != nullptr);
  }

  /// Bytes of memory for units, besides the index of cells; at least one unit.
  std::uint64_t bytes_for_units() const {
    const std::uint64_t of_cell = kCellBytes + (report_.metadata.classes ? kColumnCellBytes : 0) +
                                  (origins_ != nullptr ? kColumnCellBytes : 0);
    const std::uint64_t of_origins = origins_ != nullptr ? origins_->allocated_bytes() : 0;
    const std::uint64_t others = kBaseBytes + report_.cells * of_cell + of_origins;
    const std::uint64_t least = others + of_unit();
    if (options_.memory_bytes < least) {
      throw ResourceError(format_size(options_.memory_bytes) +
                              " of memory is too little: " + std::to_string(report_.cells) +
                              " cells " + (of_origins > 0 ? "and their origins " : "") +
                              "need at least " + std::to_string(divide_up(least, kMiB)) + " MiB",
                          Remedy::kMoreCellPoints);
    }
    return options_.memory_bytes - others;
  }

  /// Checks that memory and disk suffice for the cells, and decides whether all points wait in
  /// memory, which leaves enough for one unit per thread: those of a stream, which cannot be
  /// resumed, and those for which the disk has no room.
  void check_cells(const std::vector<TopNode>& top, std::size_t units) {
    const std::uint64_t points = report_.points;
    report_.cells = top.empty() ? 0 : top[0].cell_count;
    const std::uint64_t waiting = points * sizeof(DistributedPoint);
    units_in_flight_ = std::min(units, static_cast<std::size_t>(threads_) + 1);
    const std::uint64_t padded = std::max(points, report_.cells * options_.cell_points);
    const bool may_be_in_memory = bytes_for_units() >= waiting + units_in_flight_ * of_unit() &&
                                  waiting <= most_waiting_bytes();
    const bool has_points = journal_ && journal_->point_files() > 0;
    const DiskNeed need{points, padded, has_points ? 0 : points};
    in_memory_ =
        may_be_in_memory && !has_points && (!journal_ || bytes_of(need) > free_disk_bytes(folder_));
    if (in_memory_ && journal_) {
      log_.note(
          "the disk has too little room for temporary files, so points wait in memory, and an "
          "interruption loses all but their counts");
    }
    units_in_flight_ = std::clamp<std::size_t>(bytes_for_units() / of_unit(), 1,
                                               std::max<std::size_t>(1, units_in_flight_));
    check_disk(folder_, {points, padded, in_memory_ ? 0 : need.spooled});
    if (options_.regular_size && padded > 2 * points) {
      log_.warn("padded-cells",
                fmt::format("{} cells of {} points for {} points: the padding makes the store "
                            "large; fewer points a cell fit the cubes",
                            report_.cells, options_.cell_points, points));
    }
  }

  void write_store(Distribution& distribution, const SplitTree& tree,
                   const std::vector<TopNode>& top, const Lattice& lattice) {
    StoreWriter writer(output_.partial(), report_.metadata, report_.cells);
    write_cells(distribution, tree, lattice, report_.metadata, origins_, units_in_flight_, writer,
                clocks_, progress_);
    report_.partition_seconds = watch_.lap();
    auto closed = std::async(kBeside, [&] {
      if (journal_) journal_->remove_points();
      in_threads(threads_, [&] { distribution.close_files(); });
    });
    {
      const auto running = clocks_.measure(Stage::kWrite);
      writer.finish(top);
    }
    auto synced = std::async(kBeside, [this] {
      const auto running = clocks_.measure(Stage::kSync);
      output_.sync();
    });
    {
      const auto running = clocks_.measure(Stage::kConfirm);
      writer.confirm();
    }
    synced.get();
    closed.get();
    output_.publish();
    if (journal_) journal_->remove_after_publication();
    take_facts(report_.metadata, report_);
    report_.output_bytes = std::filesystem::file_size(options_.output);
    report_.confirm_seconds = watch_.lap();
    report_.busy_seconds = clocks_.seconds();
  }

  const ConversionOptions& options_;
  int threads_;
  Progress& progress_;
  std::filesystem::path folder_;
  PendingFile output_;
  std::string options_text_;  ///< those of the store, with files as they are at the beginning
  ConversionReport report_;
  WithheldCubes withheld_;
  std::optional<ConversionJournal> journal_;
  OriginTable* origins_ = nullptr;  ///< null where no point has an origin
  std::size_t units_in_flight_ = 1;
  bool in_memory_ = false;
  MessageLog log_{options_.message, report_.warnings};
  StageClocks clocks_;
  Stopwatch watch_;
};

}  // namespace

std::vector<Message> kept_warnings(const std::vector<Message>& warnings) {
  constexpr std::size_t kMost = 64, kMostTextBytes = 1000;
  std::vector<Message> kept = warnings;
  const std::size_t all = kept.size();
  // Those that put answers in doubt are kept before others.
  if (all > kMost) {
    std::ranges::stable_partition(kept, [](const Message& m) { return is_doubt(m.code); });
  }
  kept.resize(std::min(all, kMost));
  for (Message& warning : kept) {
    warning.text = shortened(warning.text, kMostTextBytes);
  }
  if (all > kMost) {
    const std::size_t more = all - kMost + 1;
    kept.back() = warning("more-warnings", {{"warnings", more}},
                          "the conversion gave {} more warnings, which the store does not keep; "
                          "convert again to see them",
                          format_count(more));
  }
  return kept;
}

ConversionReport convert_scans(const ConversionOptions& options, Progress& progress) {
  check_options(options);
  const int threads = affordable_threads(options);
  return in_threads(threads, [&] { return Conversion(options, threads, progress).run(); });
}

namespace {

/// The store at a path; nullopt where there is no store with a sound index.
std::optional<StoreReader> store_at(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) return std::nullopt;
  try {
    return std::optional<StoreReader>(std::in_place, path);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// Whether the inputs can be read again, so that their contents show whether they made a store.
bool can_be_read_again(const ConversionOptions& options) {
  return options.inputs != std::vector<std::filesystem::path>{"-"};
}

/// Throws UsageError where a file is at the place of the output of a conversion that is resumed,
/// and is not its store.
void refuse_other_output(const ConversionOptions& options) {
  if (options.overwrite || !std::filesystem::is_regular_file(options.output)) return;
  const std::optional<StoreReader> store = store_at(options.output);
  std::string reason = ": exists already, and is no store";
  if (store && !can_be_read_again(options)) {
    reason = ": exists already, and does not show whether it is the store of these scans";
  } else if (store) {
    const std::string differs =
        difference_of_options(store->metadata().options, store_options(options));
    reason = differs.empty() ? ": holds other scans than these"
                             : ": was converted with other options: its " + differs;
  }
  throw UsageError(options.output.string() + reason, Remedy::kOverwriteNotResume);
}

}  // namespace

bool is_converted(const ConversionOptions& options, Progress& progress) {
  if (!can_be_read_again(options)) return false;
  const std::optional<StoreReader> store = store_at(options.output);
  if (!store || store->metadata().options != store_options(options)) return false;
  // Only files that were read whole have hashes by which they are known.
  if (store->metadata().near && store->metadata().near->unread > 0) return false;
  std::vector<std::filesystem::path> files = list_point_files(options.inputs);
  if (options.skip_unreadable) {
    files = files_of(files, readable_inputs(files, {}, progress).numbers);
  }
  SourceDescription sources(with_pose_files(files), {}, progress);
  if (sources.get() != store->metadata().sources) return false;
  const std::vector<std::string> faults = verify_store(*store, progress, 1);
  if (faults.empty()) return true;
  throw UsageError(faults[0] + "; the store of these inputs is damaged",
                   Remedy::kOverwriteNotResume);
}

namespace {

/// Takes the facts and warnings of a conversion that the store keeps.
void describe(const StoreReader& store, ConvertReport& report, MessageLog& log) {
  const StoreMetadata& metadata = store.metadata();
  take_facts(metadata, report);
  report.cells = store.cells().size();
  report.non_finite_points = metadata.points_without_place();
  if (metadata.near) {
    report.box = metadata.near->whole;
  } else if (!store.tree().empty()) {
    report.box = position_box(metadata.quantisation, store.tree()[0].box);
  }
  report.output_bytes = std::filesystem::file_size(store.name());
  for (const Message& warning : metadata.warnings) log.add(warning);
}

}  // namespace

ConvertReport convert(const std::vector<std::filesystem::path>& inputs,
                      const std::filesystem::path& output, const ConvertOptions& options) {
  const ConversionOptions conversion{options, inputs, output};
  CallbackProgress progress(options.progress, options.stop);
  const bool goes_on = options.resume && unfinished_overwrites(output);
  const auto is_finished = [&] {
    try {
      return is_converted(conversion, progress);
    } catch (const UsageError&) {
      if (!goes_on) throw;
      return false;  // the damaged store is what the unfinished conversion replaces
    }
  };
  if (options.resume && is_finished()) {
    ConvertReport report{.was_finished = true};
    MessageLog log(options.message, report.warnings);
    if (!remove_left_over(conversion)) {
      log.note(output.string() +
               ".journal: belongs to an unfinished conversion of other inputs or options, and is "
               "left alone; --force removes it");
    }
    describe(StoreReader(output), report, log);
    if (options.strict) refuse_warnings(report.warnings);
    return report;
  }
  if (options.resume && !goes_on) refuse_other_output(conversion);
  return convert_scans(conversion, progress);
}

}  // namespace clearway
