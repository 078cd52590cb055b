#include "clearway/search.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>

#include "clearway/error.hpp"
#include "core/messages/messages.hpp"
#include "core/query/search_result.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "core/util/progress.hpp"
#include "core/util/stopwatch.hpp"
#include "findings/certain_points.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/thread_limit.hpp"
#include "io/paths/content_hash.hpp"
#include "io/result/answer.hpp"
#include "search/answer_question.hpp"
#include "search/check_corridor.hpp"
#include "search/check_query.hpp"
#include "search/checks/check_floor.hpp"
#include "search/checks/query_warnings.hpp"
#include "search/checks/question.hpp"
#include "search/devices.hpp"
#include "search/find_depths.hpp"
#include "search/ignored.hpp"
#include "search/memory_budget.hpp"
#include "search/result_header.hpp"
#include "search/run_journal.hpp"
#include "search/search_engines.hpp"
#include "search/seen_space.hpp"
#include "search/session_state.hpp"
#include "search/shard_cells.hpp"
#include "search/visit.hpp"
#include "stream/answer_rows.hpp"
#include "stream/search_journal.hpp"
#include "stream/write_result.hpp"

namespace clearway {
namespace {

/// What a search has found, and what its last pass has left.
struct AllFound : FoundAnswer {
  VisitEnd end;
};

/// What was read after `before`.
BytesRead since(const BytesRead& before, const BytesRead& now) {
  return {now.coordinates - before.coordinates, now.sources - before.sources,
          now.classes - before.classes, now.origins - before.origins};
}

/// The file that a result goes to, and the journal beside it.
struct OutputFile {
  OutputFile(const std::filesystem::path& path, const SearchOptions& options, MessageLog& log)
      : pending(path, true), journal(pending, path, options, log) {}

  PendingFile pending;
  RunJournal journal;
};

/// One question, step by step.
class Search {
 public:
  /// output: where the result is written; none for an answer in memory. All references outlive it.
  Search(SessionState& session, const Query& query, const SearchOptions& options,
         const std::optional<std::filesystem::path>& output)
      : session_(session),
        store_(session.store().reader()),
        query_(query),
        options_(options),
        progress_(options_.progress, options_.stop),
        log_(options_.message, report_.warnings),
        memory_(session.memory()),
        engines_(session, query, model_hashes_, options_, report_, log_) {
    if (output) file_.emplace(*output, options_, log_);
    for (const MovingBody& body : moving_bodies(query_)) {
      model_hashes_.push_back(hash_of_model(body.model));
    }
    header_ = result_header(store_, query_, model_hashes_, [&](const QueryParameters& sorted) {
      return session_.ignored(sorted, options_.threads);
    });
    // The part that a shard is turns out later.
    if (file_ && !options.overwrite && !options.resume && !options.shard) {
      file_->journal.refuse_existing(header_);
      file_->pending.refuse_existing();
    }
    options_.started = session_.start(options_);
  }

  /// Answers into the file.
  SearchReport run() {
    begin();
    divide();
    if (file_->journal.already_done(store_, header_, progress_)) {
      take_finished();
    } else {
      resolve_device();
      AllFound found = find_all();
      session_.models().forget_all();
      publish(found);
      const Stopwatch ending;
      found.end.engine_end.clear();
      report_.seconds.end_wait = ending.seconds();
    }
    report_.seconds.total = total_.seconds();
    return std::move(report_);
  }

  SearchReport answer(AnswerInMemory& kept) {
    begin();
    AllFound found = find_all();
    found.end.engine_end.clear();
    report_.ignored_looked_at = ignored_points_;
    const std::uint64_t rows_bytes = in_memory_.allocated_bytes();
    report_.needed_host_bytes += rows_bytes;
    const std::uint64_t write_bytes = found.end.write_bytes;
    const Stopwatch write;
    static_cast<ResultTables&>(kept) = session_.spare().take_tables();
    RowMemory rows = session_.spare().take_rows();
    fill_tables(store_, std::move(found), header_, write_bytes - std::min(write_bytes, rows_bytes),
                progress_, chainage(), options_.threads, rows, kept);
    session_.spare().keep(std::move(rows));
    static_cast<TableSummary&>(report_) = summary_of(kept);
    report_.seconds.write = write.seconds();
    kept.findings = findings();
    kept.header = std::move(header_);
    report_.seconds.total = total_.seconds();
    return std::move(report_);
  }

 private:
  void begin() {
    static_cast<Answer&>(report_) = answer_of(header_);
    check();
    header_.notes.inputs_hash = hash_of_inputs();
    report_sizes(store_, query_, report_);
    report_.seconds.check = total_.seconds();
  }

  /// Reports the answer of a result that was there already, and those of its warnings that have not
  /// been passed on, because only its search could give them.
  void take_finished() {
    const std::vector<Message> passed_on = report_.warnings;
    report_finished(ResultReader(file_->journal.output(), Parts::kAccepted), report_);
    for (const Message& warning : report_.warnings) {
      const bool is_known = std::ranges::any_of(
          passed_on, [&](const Message& other) { return say_the_same(other, warning); });
      if (options_.message && !is_known) options_.message(warning);
    }
  }

  /// What is searched after the colliding points: reads what was found, and adds to it.
  using Pass = void (Search::*)(AllFound& found);

  /// The further passes that the query asks for, in their order.
  std::vector<Pass> further_passes() const {
    std::vector<Pass> passes;
    if (report_.ignored.points > 0) passes.push_back(&Search::find_colliding_ignored_points);
    if (query_.first_pose) passes.push_back(&Search::find_last_poses);
    if (header_.budget) passes.push_back(&Search::find_certain);
    if (header_.budget) passes.push_back(&Search::find_near);
    if (has_floor(query_)) passes.push_back(&Search::count_below_floor);
    if (query_.seen) passes.push_back(&Search::find_unseen);
    return passes;
  }

  /// Searches all that the query asks for. Only the last pass ends the GPUs.
  AllFound find_all() {
    const std::vector<Pass> passes = further_passes();
    const bool end_gpus = std::exchange(options_.end_gpus, false);
    choose_device();
    look_at_ground();
    // A question with further searches has all the memory, because these need some of their own.
    if (query_.ignores_points() || query_.has_budget() || query_.seen || query_.depth ||
        has_floor(query_)) {
      take_memory(~0ULL);
    }
    options_.end_gpus = end_gpus && passes.empty();
    AllFound found;
    if (query_.profile > 0) found.profile = ProfileSet(store_, query_.poses.size());
    find_hits(found);
    found.rows = rows_;
    for (const Pass& pass : passes) {
      found.end.engine_end.clear();
      options_.end_gpus = end_gpus && &pass == &passes.back();
      (this->*pass)(found);
    }
    if (query_.depth) find_depths_of(found);
    if (query_.ignores_points()) {
      report_.colliding_points = rows_->points(PointQuestion::kHits);
      warn_of_colliding_ignored(report_, store_.metadata().unit, log_);
    }
    return found;
  }

  /// Checks the query and warns before anything is searched, also where the result exists already.
  void check() {
    for (const Message& message : options_.input_warnings) {
      if (message.severity == Message::Severity::kWarning) report_.warnings.push_back(message);
    }
    check_sizes(query_);
    CorridorCheck(store_.metadata()).check(query_, swept_radius());
    if (query_.seen) check_seen_space(store_, query_);
    check_depth(store_, query_);
    ThreadLimit(threads_or_all(options_.threads)).run([&] {
      const auto looks_of = [&](const Model& model) {
        return session_.looks().of(model, hash_of(model), query_.radius);
      };
      warn_of_query(store_, query_, header_.ignored, looks_of, options_.input_warnings, log_);
    });
    for (const MovingBody& body : moving_bodies(query_)) {
      check_floor(body, swept_radius(), store_.metadata().unit, metre_of(store_), log_);
    }
    note_large_errors();
    if (query_.seen) warn_of_large_cubes(store_, query_, swept_radius(), log_);
    if (options_.strict) refuse_warnings(report_.warnings);
  }

  /// ResultNotes::inputs_hash. The words of warnings name paths, by which nothing is known again.
  std::uint64_t hash_of_inputs() const {
    ColumnHashes hashes;
    std::vector<Message> warnings;
    add_warnings(report_.warnings, warnings);
    for (const Message& warning : warnings) {
      hashes.add(warning.code);
      for (const auto& [name, number] : warning.numbers) hashes.add(std::array{number});
      for (const PoseRange& stretch : warning.stretches) {
        hashes.add(std::array{stretch.first, stretch.last});
      }
    }
    const StoreMetadata& metadata = store_.metadata();
    hashes.add(metadata.dates.first + "/" + metadata.dates.last);
    hashes.add(std::array{metadata.withheld ? metadata.withheld->left_out() : 0});
    if (query_.seen && metadata.origins) hashes.add(std::array{metadata.origins->hash});
    return hashes.digest();
  }

  /// Tells before the search where the ground will collide.
  void look_at_ground() {
    if (!options_.message) return;  // nobody would see the note
    const double cube = query_.seen ? 0.5 * side_of_cubes(store_, query_.seen_cube) : 0;
    const double more = swept_radius() - query_.radius + cube;
    for (const MovingBody& body : moving_bodies(query_)) {
      const auto index =
          session_.models().index_of(body.model, hash_of(body.model), options_.threads);
      look_for_ground(store_, store_.metadata().unit, metre_of(store_), query_, more, body, *index,
                      log_);
    }
  }

  /// The hash of one of the query's own models.
  std::uint64_t hash_of(const Model& model) const {
    const std::vector<MovingBody> bodies = moving_bodies(query_);
    const auto is_it = [&](const MovingBody& body) { return &body.model == &model; };
    const auto body = std::ranges::find_if(bodies, is_it);
    return model_hashes_[static_cast<std::size_t>(body - bodies.begin())];
  }

  /// The distance from the model at which a place counts as swept.
  double swept_radius() const {
    return header_.budget ? header_.budget->near_radius(query_.radius) : query_.radius;
  }

  /// Notes where the errors are so large that no surface could be a certain conflict.
  void note_large_errors() {
    if (!header_.budget || header_.model_solids > 0) return;
    const double errors = header_.budget->conflict();
    if (query_.radius > errors) return;
    const LengthUnit unit = store_.metadata().unit;
    log_.add(
        note("errors-exceed-margin",
             "the errors of " + length_text(errors, unit) + " are not below the margin of " +
                 length_text(query_.radius, unit) +
                 ", so that no point outside the vehicle is certainly too close: nothing can be a "
                 "conflict. Search a closed mesh as a solid, because points deep inside it are "
                 "certain; a mesh that is not closed has to be resampled for that",
             {{"errors", errors}, {"margin", query_.radius}}));
  }

  /// Finds out which cells a shard has.
  void divide() {
    if (!options_.shard) return;
    throw_if_stopped(progress_);
    shard_.emplace(store_, query_, *options_.shard, threads_or_all(options_.threads),
                   options_.memory_bytes);
    header_.part = shard_->part();
    report_.shard = options_.shard;
    report_.shard_share = shard_->share();
  }

  const ShardCells* only() const { return shard_ ? &*shard_ : nullptr; }

  /// Where a run is resumed, device kAuto continues with the device of that run.
  void resolve_device() {
    const Device earlier = file_->journal.earlier_device();
    if (options_.device == Device::kAuto && options_.gpus.empty() && earlier != Device::kAuto) {
      options_.device = earlier;
      if (earlier == Device::kCpu) options_.device_memory_bytes = 0;
    }
    throw_if_stopped(progress_);
  }

  void choose_device() {
    options_.threads = threads_or_all(options_.threads);
    const Device device = engines_.choose_device();
    report_.engine = options_.engine;
    report_.device = device;
  }

  /// The first pass: finds the colliding points, with what is asked about each of them. A GPU that
  /// the user did not ask for is given up for the CPU only before the journal is open.
  void find_hits(AllFound& found) {
    found.end = engines_.on(
        report_.device, [&](Device device) { return find_on(device, found.profile); },
        [&](const ResourceError&) {
          if (journal_ != nullptr) throw;
        });
    ignored_points_ = found.end.ignored_points;
    if (file_) report_.resumed_cells = file_->journal.earlier_cells();
  }

  void take_memory(std::uint64_t bytes) { memory_.take(bytes, progress_); }

  VisitEnd find_on(Device device, ProfileSet& profile) {
    report_.device = device;
    report_.device_name = DeviceChoice().name;
    // A journal that does not match is refused before anything is planned.
    if (device == Device::kCpu || !fallback_allowed(options_)) open_rows(profile);
    const std::unique_ptr<PageEngineKind> kind = engines_.kind(device, store_, query_, options_);
    CollectPage keep;
    return run_visit(
        store_,
        {.query = query_,
         .memory_bytes = options_.memory_bytes,
         .kind = *kind,
         .only = only(),
         .collect = [&](std::span<const PlannedCell> cells,
                        const PageResult& page) { keep(cells, page); },
         .answered =
             [&](std::uint32_t cell) { return rows_->answered(cell, PointQuestion::kHits); },
         .least_write_bytes = least_write_bytes(store_, query_),
         .planned =
             [&](std::uint64_t host, std::uint64_t on_device) {
               take_memory(host + (file_ ? 0 : kMemoryStep));
               engines_.take_device_memory(on_device, progress_);
             },
         .made =
             [&] {
               open_rows(profile);
               keep = keep_answer(store_, *rows_, profile, journal_);
             }},
        progress_, report_, log_);
  }

  /// The cells in which a question has found points.
  ShardCells cells_with(PointQuestion question) const {
    std::vector<bool> in(store_.cells().size());
    for (const std::uint32_t cell : rows_->cells(question)) in[cell] = true;
    return ShardCells(std::move(in));
  }

  /// Searches the ignored points alone. The numbers do not depend on the device.
  void find_colliding_ignored_points(AllFound&) {
    const Stopwatch clock;
    further_.query = query_of_ignored(query_);
    further_.options = options_;
    further_.options.engine = Engine::kSweep;
    const SearchReport taken = engines_.on(report_.device, [&](Device device) {
      return find_colliding_ignored(
          store_, further_.query, options_.memory_bytes,
          *engines_.kind(device, store_, further_.query, further_.options), only(), *rows_,
          progress_);
    });
    report_.needed_host_bytes = std::max(report_.needed_host_bytes, taken.needed_host_bytes);
    report_.peak_device_bytes = std::max(report_.peak_device_bytes, taken.peak_device_bytes);
    report_.ignored_colliding = rows_->points(PointQuestion::kIgnored);
    report_.ignored_colliding_high = rows_->points(PointQuestion::kIgnoredHigh);
    report_.seconds.ignored = clock.seconds();
  }

  /// Searches the cells that have colliding points once more, with the poses in reverse order. The
  /// last of a single pose is the first one.
  void find_last_poses(AllFound& found) {
    const ShardCells cells = cells_with(PointQuestion::kHits);
    if (query_.poses.size() == 1 || cells.empty()) return;
    search_further(found, backwards(query_), &cells, "last poses", PointQuestion::kLast,
                   [this](std::uint32_t cell, const FoundInCell& page) {
                     rows_->add(cell, {{PointQuestion::kLast, page.hits}});
                   });
  }

  /// The query without what a further search for points alone does not need. Floors keep their
  /// distance from the places that the radius reaches.
  Query plain_query(double radius, bool first_pose) const {
    Query query = query_;
    query.radius = radius;
    raise_floors(query, query_.radius - radius);
    query.first_pose = first_pose;
    query.depth = false;
    query.clearance = query.profile = 0;
    query.error_scan = query.error_registration = query.error_pose = query.error_angle =
        query.error_model = std::nullopt;
    return query;
  }

  /// Finds the colliding points that by the error budget are certainly too close, and whether
  /// enough of these hang together.
  void find_certain(AllFound& found) {
    find_certain_points(found);
    ThreadLimit(options_.threads).run([&] {
      CertainGroup group(store_.quantisation(), header_.gap, progress_);
      for (const std::uint32_t cell : rows_->cells(PointQuestion::kCertain)) {
        const auto q = store_.coordinates(cell);
        rows_->read(cell, PointQuestion::kCertain).for_each([&](std::uint32_t i, std::size_t) {
          group.add({q[0][i], q[1][i], q[2][i]});
        });
      }
      report_.certain = group.found();
    });
  }

  /// Finds the colliding points that are closer than the certain radius, which is at most that of
  /// the query. Below 0 these are the points that are deeper than it inside a solid, and for a
  /// model without solids there is none.
  void find_certain_points(AllFound& found) {
    const double radius = header_.budget->certain_radius(query_.radius);
    const ShardCells cells = cells_with(PointQuestion::kHits);
    if (cells.empty()) return;
    if (!(radius < query_.radius)) {
      for (const std::uint32_t cell : rows_->cells(PointQuestion::kHits)) {
        if (rows_->answered(cell, PointQuestion::kCertain)) continue;
        const CellRows all{.words = rows_->read(cell, PointQuestion::kHits).words};
        rows_->add(cell, {{PointQuestion::kCertain, all}});
      }
    } else if (radius > 0) {
      search_further(found, plain_query(radius, false), &cells, "certain points",
                     PointQuestion::kCertain, [this](std::uint32_t cell, const FoundInCell& page) {
                       rows_->add(cell, {{PointQuestion::kCertain, page.hits}});
                     });
    } else if (has_solids(query_)) {
      Query signed_query = plain_query(query_.radius, false);
      signed_query.clearance = query_.radius;
      raise_floors(signed_query, query_.radius - radius);
      const double deeper = -(radius * radius);
      search_further(found, std::move(signed_query), &cells, "certain points",
                     PointQuestion::kCertain,
                     [this, deeper](std::uint32_t cell, const FoundInCell& page) {
                       const CellRows hits = rows_->read(cell, PointQuestion::kHits);
                       const CellRows certain =
                           points_where(page.clearances, [&](std::uint32_t point, std::size_t row) {
                             return page.clearances.distances[row] < deeper && hits.contains(point);
                           });
                       rows_->add(cell, {{PointQuestion::kCertain, certain}});
                     });
    }
  }

  /// Finds the points that do not collide but may be too close by the error budget.
  void find_near(AllFound& found) {
    const double radius = header_.budget->near_radius(query_.radius);
    if (!(radius > query_.radius)) return;
    search_further(found, plain_query(radius, query_.first_pose), only(), "near points",
                   PointQuestion::kNear, [this](std::uint32_t cell, const FoundInCell& page) {
                     rows_->add(cell,
                                {{PointQuestion::kNear,
                                  without(page.hits, rows_->read(cell, PointQuestion::kHits))}});
                   });
  }

  /// Counts the points that a search of the set without floors finds, and that are neither
  /// colliding nor near. Its seconds are reported apart from those of the search.
  void count_below_floor(AllFound& found) {
    const Stopwatch clock;
    const SearchSeconds before = report_.seconds;
    Query query = plain_query(query_.radius, false);
    query.floor.reset();
    for (Body& body : query.bodies) body.floor.reset();
    search_further(found, std::move(query), only(), "below the floor", PointQuestion::kBelow,
                   [this](std::uint32_t cell, const FoundInCell& page) {
                     rows_->add(cell,
                                {{PointQuestion::kBelow,
                                  without(page.hits, rows_->read(cell, PointQuestion::kHits))}});
                   });
    std::uint64_t below = header_.budget ? 0 : rows_->points(PointQuestion::kBelow);
    if (header_.budget) {
      for (const std::uint32_t cell : rows_->cells(PointQuestion::kBelow)) {
        below += without(rows_->read(cell, PointQuestion::kBelow),
                         rows_->read(cell, PointQuestion::kNear))
                     .count();
      }
    }
    report_.floor_colliding = below;
    report_.seconds = before;
    report_.seconds.below = clock.seconds();
  }

  /// Finds the free point that is nearest to each colliding one, on the CPU, after all searches for
  /// points.
  void find_depths_of(AllFound& found) {
    const Stopwatch clock;
    // What search_result_bytes() set aside for depths, and what there is to write with
    const std::uint64_t memory = depth_bytes(store_, query_) + found.end.write_bytes;
    try {
      report_.needed_host_bytes +=
          find_depths(store_, query_, *rows_, options_.threads, memory, progress_);
    } catch (const ResourceError& error) {
      if (error.remedy() != Remedy::kMoreMemory || !(error.amount() > 0)) throw;
      const auto needed = static_cast<std::uint64_t>(error.amount());
      refuse_memory(options_.memory_bytes + (needed - std::min(needed, memory)),
                    options_.memory_bytes);
    }
    found.end.write_bytes = memory - kDeepWriteBytes;
    report_.seconds.depth = clock.seconds();
  }

  /// Finds out which places that the model sweeps no beam of the scanner passed through. A shard
  /// follows the beams of its own cells; the groups of what none of them saw are made by the merge.
  void find_unseen(AllFound& found) {
    cells_read_ = store_.cells_touched();
    further_.options = options_;
    further_.options.engine = Engine::kSweep;
    further_.options.end_gpus = false;  // following the beams does
    SeenSpace space = engines_.on(report_.device, [&](Device device) {
      return seen_space_on(device, found.end.write_bytes);
    });
    report_.seconds.swept = space.sweep_seconds;
    report_.seconds.beams = space.beam_seconds;
    report_.peak_device_bytes = std::max(report_.peak_device_bytes, space.taken.peak_device_bytes);
    warn_of_beams(space.left_out, log_);
    warn_of_nothing_swept(space.summary, query_.poses.size(), log_);
    if (!options_.shard) {
      group_unseen(query_, space.unseen, space.summary);
      warn_of_small_groups(space.summary, query_, log_);
    }
    report_.seen = space.summary;
    const std::uint64_t rows =
        space.unseen.size() * kUnseenRowBytes + space.swept.size() * kSweptRowBytes;
    found.end.write_bytes -= std::min(found.end.write_bytes / 2, rows);
    found.unseen = std::move(space.unseen);
    found.swept = std::move(space.swept);
  }

  /// memory_bytes: what the search so far leaves.
  SeenSpace seen_space_on(Device device, std::uint64_t memory_bytes) {
    SeenSearch how{.radius = swept_radius(),
                   .memory_bytes = memory_bytes,
                   .threads = options_.threads,
                   .only = only(),
                   .kind =
                       [&](const PackedCloud& cloud, const Query& query) {
                         return engines_.kind(device, cloud, query, further_.options);
                       },
                   .follow_on_gpus = {}};
    if (device == Device::kCuda) {
      how.follow_on_gpus = [&](const Beams& beams, std::span<const PlannedCell> cells,
                               std::uint64_t bytes, BrickMap& map) {
        return engines_.follow_beams(cells, beams, map, bytes, progress_);
      };
    }
    try {
      return find_seen_space(store_, query_, how, progress_);
    } catch (const ResourceError& error) {
      if (error.remedy() != Remedy::kMoreMemory) throw;
      const std::uint64_t needed =
          options_.memory_bytes - memory_bytes + static_cast<std::uint64_t>(error.amount());
      throw ResourceError(format_size(options_.memory_bytes) +
                              " of memory is too little: to find what was not scanned needs " +
                              format_size(needed) +
                              " or more beside the mapped store; larger cubes need less",
                          Remedy::kMoreMemory);
    }
  }

  /// What a further search found in one cell of a page.
  struct FoundInCell {
    CellRows hits, clearances;
  };
  using KeepCell = std::function<void(std::uint32_t cell, const FoundInCell&)>;

  /// Searches all cells, or those of `cells`, for another query after the first search, as stage
  /// `name`; cells for which `question` is answered are left out. keep: called for each cell.
  /// Leaves in `found` the end of the engines and the memory that is left to write with.
  void search_further(AllFound& found, Query query, const ShardCells* cells, const char* name,
                      PointQuestion question, const KeepCell& keep) {
    further_.query = std::move(query);
    further_.options = options_;
    // What the first search took is enough, except for rounding in the plan.
    further_.options.memory_bytes += options_.memory_bytes / 16;
    SearchReport report;
    const MessageCallback silent;
    const MessageLog log(silent, report.warnings);
    const CollectPage collect = [&](std::span<const PlannedCell> of, const PageResult& page) {
      for (std::size_t i = 0; i < of.size(); ++i) {
        keep(of[i].cell, {hit_rows(store_, page, i), clearance_rows(store_, page, i)});
      }
    };
    VisitEnd end = engines_.on(report_.device, [&](Device device) {
      const auto kind = engines_.kind(device, store_, further_.query, further_.options);
      return run_visit(
          store_,
          {.query = further_.query,
           .memory_bytes = further_.options.memory_bytes,
           .kind = *kind,
           .only = cells,
           .collect = collect,
           .answered = [&](std::uint32_t cell) { return rows_->answered(cell, question); },
           .stage = name,
           .least_write_bytes = least_write_bytes(store_, further_.query)},
          progress_, report, log);
    });
    found.end.engine_end = std::move(end.engine_end);
    found.end.write_bytes = std::min(found.end.write_bytes, end.write_bytes);
    add_seconds(report.seconds, report_.seconds);
  }

  static void add_seconds(const SearchSeconds& more, SearchSeconds& seconds) {
    for (const auto stage : {&SearchSeconds::field, &SearchSeconds::plan, &SearchSeconds::engine,
                             &SearchSeconds::search, &SearchSeconds::read, &SearchSeconds::upload,
                             &SearchSeconds::compute, &SearchSeconds::collect}) {
      seconds.*stage += more.*stage;
    }
  }

  /// Opens where rows are kept: the journal of the output file, with what it holds already, or
  /// memory. profile: gets the nearest points that the journal holds.
  void open_rows(ProfileSet& profile) {
    if (rows_ != nullptr) return;
    if (file_) {
      journal_ = &file_->journal.open(store_, query_, header_, report_.engine, report_.device);
      if (query_.profile > 0) journal_->restore(profile);
      rows_ = &journal_->rows();
    } else {
      rows_ = &rows_in_memory_.emplace(store_, query_, in_memory_);
    }
  }

  /// Takes memory for so many bytes of rows of an answer in memory, in all. It does not wait for
  /// other questions, which may wait for this one.
  void take_for_rows(std::uint64_t bytes) {
    const std::uint64_t needed = report_.needed_host_bytes + bytes;
    if (memory_.grow(needed)) return;
    throw ResourceError(format_size(options_.memory_bytes) +
                            " of memory is too little for what this question finds: it needs " +
                            format_size(needed) +
                            " or more. A result file keeps what is found on the disk",
                        Remedy::kMoreMemory, static_cast<double>(needed));
  }

  std::vector<double> chainage() const {
    return query_.profile > 0 ? chainage_of(query_.poses) : std::vector<double>();
  }

  void publish(const AllFound& found) {
    const Stopwatch write;
    try {
      static_cast<TableSummary&>(report_) =
          write_result(store_, found, header_, file_->pending.partial(), found.end.write_bytes,
                       progress_, chainage(), options_.threads, findings());
      store_.check_read();
      file_->pending.publish();
    } catch (const ResourceError& error) {
      throw ResourceError(error.what(), Remedy::kResume);
    }
    file_->journal.remove_after_publication();
    report_.cells_read = cells_read_.value_or(store_.cells_touched());
    report_.ignored_looked_at = ignored_points_;
    report_.bytes_read = since(bytes_before_, store_.bytes_read());
    report_.seconds.write = write.seconds();
  }

  ResultFindings findings() const {
    ResultFindings found;
    add_warnings(report_.warnings, found.warnings);
    found.scanned = store_.metadata().dates;
    if (const auto& withheld = store_.metadata().withheld) {
      found.withheld_points = withheld->left_out();
    }
    if (!query_.bodies.empty()) found.searched = report_.searched;
    if (query_.profile > 0) {
      found.without_bodies = poses_without_bodies(query_.poses.size(), query_.bodies);
    }
    if (header_.budget) found.certain = report_.certain;
    found.seen = report_.seen;
    found.floor_colliding = report_.floor_colliding;
    if (!query_.ignores_points()) return found;
    found.ignored_colliding = report_.ignored_colliding;
    found.ignored_colliding_high = report_.ignored_colliding_high;
    return found;
  }

  const Stopwatch total_;
  SessionState& session_;
  const StoreReader& store_;
  const Query& query_;
  SearchOptions options_;  ///< as far as resolved
  SearchReport report_;
  CallbackProgress progress_;
  MessageLog log_;
  SharedMemory::Share memory_;
  std::optional<OutputFile> file_;
  /// hash_of_model() of the model, or of the model of each body.
  std::vector<std::uint64_t> model_hashes_;
  ResultHeader header_;
  SearchEngines engines_;
  std::optional<ShardCells> shard_;
  /// The cells that the searches for points have read, set before beams are followed.
  std::optional<std::uint64_t> cells_read_;
  /// What earlier searches of the same store have read
  const BytesRead bytes_before_ = store_.bytes_read();
  /// The query and the options of a further pass, which outlive its engines.
  struct Further {
    Query query;
    SearchOptions options;
  } further_;
  std::uint64_t ignored_points_ = 0;  ///< in the cells that the first pass searched
  SearchJournal* journal_ = nullptr;  ///< null before it is open, and for an answer in memory
  RowsInMemory in_memory_{[this](std::uint64_t bytes) { take_for_rows(bytes); }};
  std::optional<AnswerRows> rows_in_memory_;
  AnswerRows* rows_ = nullptr;  ///< what was found; null before it is open
};

void check_question(const Query& query, const SearchOptions& options) {
  check_query(query, options);
  check_bodies(query, options);
  if (query.model.is_surface()) check_surface(query, options);
}

/// Whether a file is a result or a part of one.
bool is_result(const std::filesystem::path& file) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown)) return false;
  try {
    const ResultReader opened(file, Parts::kAccepted);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

void check_search(const QueryParameters& query, const std::filesystem::path& output,
                  const SearchOptions& options) {
  check_query(query, options);
  PendingFile pending(output, true);
  const MessageCallback silent;
  std::vector<Message> none;
  MessageLog log(silent, none);
  const RunJournal journal(pending, output, options, log);
  // Whether an existing result answers this query is known only once the inputs are read.
  if (!options.overwrite && !options.resume && !is_result(output)) pending.refuse_existing();
}

SearchReport search(const Store& store, const Query& query, const std::filesystem::path& output,
                    const SearchOptions& options) {
  check_question(query, options);
  refuse_overwriting(output, {store.path()});
  SessionState session(store, options, KeptModels::Kept::kOneField);
  return Search(session, query, options, output).run();
}

SearchReport answer_question(SessionState& session, const Query& query,
                             const SearchOptions& options, AnswerInMemory& answer) {
  check_question(query, options);
  return Search(session, query, options, std::nullopt).answer(answer);
}

}  // namespace clearway
