#include "clearway/search.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
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
#include "search/choose_engine.hpp"
#include "search/devices.hpp"
#include "search/find_depths.hpp"
#include "search/ignored.hpp"
#include "search/memory_budget.hpp"
#include "search/page_search.hpp"
#include "search/result_header.hpp"
#include "search/run_journal.hpp"
#include "search/search_engines.hpp"
#include "search/seen_space.hpp"
#include "search/session_state.hpp"
#include "search/shard_cells.hpp"
#include "stream/gather_rows.hpp"
#include "stream/write_result.hpp"

namespace clearway {
namespace {

/// Passes on the progress of a search within a search under a name of its own.
class StageOf final : public Progress {
 public:
  StageOf(Progress& all, std::string_view name) : all_(all), name_(name) {}
  void begin(std::string_view, std::uint64_t total, std::string_view unit) override {
    all_.begin(name_, total, unit);
  }
  void advance(std::uint64_t units) override { all_.advance(units); }
  void end() override { all_.end(); }
  bool stop_requested() const override { return all_.stop_requested(); }

 private:
  Progress& all_;
  std::string_view name_;
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
      Found found = find_all();
      session_.models().forget_all();
      publish(found);
      const Stopwatch ending;
      found.engine_end.clear();
      report_.seconds.end_wait = ending.seconds();
    }
    report_.seconds.total = total_.seconds();
    return std::move(report_);
  }

  SearchReport answer(AnswerInMemory& kept) {
    begin();
    Found found = find_all();
    found.engine_end.clear();
    report_.ignored_looked_at = found.result.ignored_points;
    const Stopwatch write;
    static_cast<ResultTables&>(kept) = session_.spare().take_tables();
    RowMemory rows = session_.spare().take_rows();
    fill_tables(store_, std::move(found.result), header_, found.write_bytes, progress_, chainage(),
                options_.threads, rows, kept);
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

  /// What is searched after the colliding points: reads the hits, and adds a part to what was
  /// found.
  using Pass = void (Search::*)(Found& found);

  /// The further passes that the query asks for, in their order.
  std::vector<Pass> further_passes() const {
    std::vector<Pass> passes;
    if (query_.first_pose) passes.push_back(&Search::find_last_poses);
    if (header_.budget) passes.push_back(&Search::find_certain);
    if (header_.budget) passes.push_back(&Search::find_near);
    if (has_floor(query_)) passes.push_back(&Search::count_below_floor);
    if (query_.seen) passes.push_back(&Search::find_unseen);
    return passes;
  }

  /// Searches all that the query asks for. Only the last pass ends the GPUs.
  Found find_all() {
    const std::vector<Pass> passes = further_passes();
    const bool end_gpus = std::exchange(options_.end_gpus, false);
    choose_device_and_engine();
    look_at_ground();
    // A question with further searches has all the memory, because these need some of their own.
    if (query_.ignores_points() || query_.has_budget() || query_.seen || query_.depth ||
        has_floor(query_)) {
      take_memory(~0ULL);
    }
    const CollidingIgnored ignored = count_ignored_that_collide();
    options_.end_gpus = end_gpus && passes.empty();
    Found found = find_hits();
    report_.needed_host_bytes = std::max(report_.needed_host_bytes, ignored.needed_host_bytes);
    report_.peak_device_bytes = std::max(report_.peak_device_bytes, ignored.peak_device_bytes);
    for (const Pass& pass : passes) {
      found.engine_end.clear();
      options_.end_gpus = end_gpus && &pass == &passes.back();
      (this->*pass)(found);
    }
    if (query_.depth) find_depths_of(found);
    if (query_.ignores_points()) {
      report_.colliding_points = found.result.hits.count();
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

  void choose_device_and_engine() {
    options_.threads = threads_or_all(options_.threads);
    const Device device = engines_.choose_device();
    // What the sweep looks up of a model stays for the next question of a session.
    if (session_.is_session() && options_.engine == Engine::kAuto) options_.engine = Engine::kSweep;
    const Engine earlier = file_ ? file_->journal.earlier_engine() : Engine::kAuto;
    options_.engine = choose_engine(store_, query_, earlier, device == Device::kCuda, options_);
    report_.engine = options_.engine;
    report_.device = options_.engine == Engine::kKdtree ? Device::kCpu : device;
  }

  /// The first pass: finds the colliding points, with what is asked about each of them.
  Found find_hits() {
    Found found = options_.engine == Engine::kKdtree ? find_by_kdtree() : find_on_pages();
    if (file_) {
      report_.resumed_cells = file_->journal.earlier().cells;
      report_.resumed_poses = file_->journal.earlier().poses;
    }
    return found;
  }

  Found find_by_kdtree() {
    take_memory(kdtree_needed_bytes(store_, query_, options_));
    return search_kdtree(store_, query_, only(), options_, open_journal(), progress_, report_);
  }

  void take_memory(std::uint64_t bytes) { memory_.take(bytes, progress_); }

  /// Searches the ignored points alone. This comes before the first pass because it leaves nothing
  /// in memory. The journal does not keep it, so a run that is resumed repeats it. The numbers do
  /// not depend on the device.
  CollidingIgnored count_ignored_that_collide() {
    CollidingIgnored ignored;
    if (!query_.ignores_points()) return ignored;
    const Stopwatch clock;
    if (report_.ignored.points > 0) {
      const Query query = query_of_ignored(query_);
      SearchOptions options = options_;
      options.engine = Engine::kSweep;
      ignored = engines_.on(report_.device, [&](Device device) {
        return count_colliding_ignored(store_, query, options.memory_bytes,
                                       *engines_.kind(device, store_, query, options), only(),
                                       progress_);
      });
    }
    report_.ignored_colliding = ignored.points;
    report_.ignored_colliding_high = ignored.high;
    report_.seconds.ignored = clock.seconds();
    return ignored;
  }

  /// Searches page by page. A GPU that the user did not ask for is given up for the CPU only before
  /// the journal is open.
  Found find_on_pages() {
    return engines_.on(
        report_.device, [&](Device device) { return find_on(device); },
        [&](const ResourceError&) {
          if (open_ != nullptr) throw;
        });
  }

  Found find_on(Device device) {
    report_.device = device;
    report_.device_name = DeviceChoice().name;
    // A journal that does not match is refused before anything is planned.
    if (device == Device::kCpu || !fallback_allowed(options_)) open_journal();
    const std::unique_ptr<PageEngineKind> kind = engines_.kind(device, store_, query_, options_);
    return search_pages(store_, query_, options_.memory_bytes, *kind, only(),
                        {.planned =
                             [this](std::uint64_t host, std::uint64_t on_device) {
                               take_memory(host);
                               engines_.take_device_memory(on_device, progress_);
                             },
                         .open_journal = [this] { return open_journal(); }},
                        progress_, report_, log_);
  }

  /// The cells that have entries of a set.
  template <typename Set>
  ShardCells cells_with(const Set& set, const SearchResult& result) const {
    SetCells with;
    ThreadLimit(options_.threads).run([&] { with = cells_of(store_, set, result.cells); });
    std::vector<bool> in(store_.cells().size());
    for (const std::uint32_t cell : with.cells) in[cell] = true;
    return ShardCells(std::move(in));
  }

  /// Searches the cells that have colliding points once more, with the poses in reverse order.
  void find_last_poses(Found& found) {
    if (query_.poses.size() == 1) {  // the last pose is the first one
      found.result.last_poses.emplace(query_, HitSet(store_.entry_count(), true));
      return;
    }
    const ShardCells cells = cells_with(found.result.hits, found.result);
    if (cells.empty()) return;
    Found other = search_further(found, backwards(query_), &cells, "last poses");
    found.result.last_poses.emplace(query_, std::move(other.result.hits));
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

  /// Calls work(word) for the number of each 64 entries, in parallel.
  template <typename Work>
  void for_each_word_of_entries(const Work& work) const {
    const std::uint64_t words = store_.entry_count() / 64;
    ThreadLimit(options_.threads).run([&] {
      tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, words, 1024), [&](const auto& range) {
        for (std::uint64_t word = range.begin(); word != range.end(); ++word) work(word);
      });
    });
  }

  /// Finds the colliding points that by the error budget are certainly too close, and whether
  /// enough of these hang together.
  void find_certain(Found& found) {
    found.result.certain = certain_points(found);
    ThreadLimit(options_.threads).run([&] {
      const HitSet& certain = *found.result.certain;
      CertainGroup group(store_.quantisation(), header_.gap, progress_);
      for (const std::uint32_t cell : cells_of(store_, certain).cells) {
        const auto q = store_.coordinates(cell);
        for_each_entry(store_, certain, cell, [&](std::uint64_t, std::uint32_t i) {
          group.add({q[0][i], q[1][i], q[2][i]});
        });
      }
      report_.certain = group.found();
    });
  }

  /// The colliding points that are closer than the certain radius, which is at most that of the
  /// query. Below 0 these are the points that are deeper than it inside a solid, and for a model
  /// without solids there is none.
  HitSet certain_points(Found& found) {
    const double radius = header_.budget->certain_radius(query_.radius);
    const HitSet& hits = found.result.hits;
    HitSet certain(store_.entry_count(), false);
    const ShardCells cells = cells_with(hits, found.result);
    if (cells.empty()) return certain;
    if (!(radius < query_.radius)) {
      for_each_word_of_entries([&](std::uint64_t word) {
        if (const std::uint64_t bits = hits.word(word)) certain.mark_word(word, bits);
      });
    } else if (radius > 0) {
      Found other = search_further(found, plain_query(radius, false), &cells, "certain points");
      certain = std::move(other.result.hits);
    } else if (has_solids(query_)) {
      Query signed_query = plain_query(query_.radius, false);
      signed_query.clearance = query_.radius;
      raise_floors(signed_query, query_.radius - radius);
      const Found other = search_further(found, std::move(signed_query), &cells, "certain points");
      const double deeper = -(radius * radius);
      for_each_word_of_entries([&](std::uint64_t word) {
        for (std::uint64_t bits = hits.word(word); bits != 0; bits &= bits - 1) {
          const std::uint64_t entry = 64 * word + static_cast<unsigned>(std::countr_zero(bits));
          if (other.result.clearances.at(entry).squared < deeper) certain.mark(entry);
        }
      });
    }
    return certain;
  }

  /// Finds the points that do not collide but may be too close by the error budget.
  void find_near(Found& found) {
    const double radius = header_.budget->near_radius(query_.radius);
    const HitSet& hits = found.result.hits;
    if (!(radius > query_.radius)) {
      found.result.near.emplace(store_.entry_count(), query_.first_pose);
      return;
    }
    Found other =
        search_further(found, plain_query(radius, query_.first_pose), only(), "near points");
    HitSet& near = found.result.near.emplace(std::move(other.result.hits));
    for_each_word_of_entries([&](std::uint64_t word) {
      if (const std::uint64_t both = near.word(word) & hits.word(word)) near.forget(word, both);
    });
  }

  /// Counts the points that a search of the set without floors finds, and that are neither
  /// colliding nor near. Its seconds are reported apart from those of the search.
  void count_below_floor(Found& found) {
    const Stopwatch clock;
    const SearchSeconds before = report_.seconds;
    Query query = plain_query(query_.radius, false);
    query.floor.reset();
    for (Body& body : query.bodies) body.floor.reset();
    Found all = search_further(found, std::move(query), only(), "below the floor");
    const SearchResult& result = found.result;
    std::atomic<std::uint64_t> below = 0;
    for_each_word_of_entries([&](std::uint64_t word) {
      const std::uint64_t judged =
          result.hits.word(word) | (result.near ? result.near->word(word) : 0);
      const std::uint64_t left = all.result.hits.word(word) & ~judged;
      if (left != 0) below += static_cast<std::uint64_t>(std::popcount(left));
    });
    report_.floor_colliding = below;
    report_.seconds = before;
    report_.seconds.below = clock.seconds();
    if (query_.depth) without_floors_.emplace(std::move(all.result.hits));
  }

  /// Finds the free point that is nearest to each colliding one, on the CPU, after all searches for
  /// points. No journal keeps the depths, so a run that is resumed finds them again.
  void find_depths_of(Found& found) {
    const Stopwatch clock;
    // What further_bytes() set aside for depths, and what there is to write with
    const std::uint64_t memory = depth_bytes(store_, query_) + found.write_bytes;
    const HitSet* const below = without_floors_ ? &*without_floors_ : nullptr;
    const std::uint64_t taken = below != nullptr ? below->allocated_bytes() : 0;
    const std::uint64_t rows =
        DepthSet::bytes(store_.entry_count(), found.result.hits.count()) + kDeepWriteBytes;
    const auto refuse = [&](std::uint64_t needed) {
      refuse_memory(options_.memory_bytes + (needed - std::min(needed, memory)),
                    options_.memory_bytes);
    };
    if (rows + least_write_bytes(store_) > memory) refuse(rows + least_write_bytes(store_));
    try {
      found.result.depths = find_depths(store_,
                                        {.query = query_,
                                         .found = found.result,
                                         .below = below,
                                         .threads = options_.threads,
                                         .memory_bytes = memory - taken},
                                        progress_);
    } catch (const ResourceError& error) {
      if (error.remedy() != Remedy::kMoreMemory) throw;
      refuse(taken + static_cast<std::uint64_t>(error.amount()));
    }
    without_floors_.reset();
    found.write_bytes = memory - rows;
    report_.needed_host_bytes += found.result.hits.count() * sizeof(Depth);
    report_.seconds.depth = clock.seconds();
  }

  /// Finds out which places that the model sweeps no beam of the scanner passed through. A shard
  /// follows the beams of its own cells; the groups of what none of them saw are made by the merge.
  void find_unseen(Found& found) {
    cells_read_ = store_.cells_touched();
    further_.options = options_;
    further_.options.engine = Engine::kSweep;
    further_.options.end_gpus = false;  // following the beams does
    SeenSpace space = engines_.on(
        report_.device, [&](Device device) { return seen_space_on(device, found.write_bytes); });
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
    found.write_bytes -= std::min(found.write_bytes / 2, rows);
    found.result.unseen = std::move(space.unseen);
    found.result.swept = std::move(space.swept);
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

  /// Searches all cells, or those of `cells`, for another query after the first search, as stage
  /// `name`. No journal keeps this search, so a run that is resumed begins it again. Leaves in
  /// `found` the end of the engines and the memory that is left to write with.
  Found search_further(Found& found, Query query, const ShardCells* cells, const char* name) {
    further_.query = std::move(query);
    further_.options = options_;
    // What the first search took is enough, except for rounding in the plan.
    further_.options.memory_bytes += options_.memory_bytes / 16;
    SearchReport report;
    const MessageCallback silent;
    const MessageLog log(silent, report.warnings);
    StageOf progress(progress_, name);
    Found other = [&] {
      const auto& [asked, options] = further_;
      if (report_.engine == Engine::kKdtree) {
        return search_kdtree(store_, asked, cells, options, nullptr, progress, report);
      }
      return engines_.on(report_.device, [&](Device device) {
        return search_pages(store_, asked, options.memory_bytes,
                            *engines_.kind(device, store_, asked, options), cells, {}, progress,
                            report, log);
      });
    }();
    found.engine_end = std::move(other.engine_end);
    found.write_bytes = std::min(found.write_bytes, other.write_bytes);
    add_seconds(report.seconds, report_.seconds);
    return other;
  }

  static void add_seconds(const SearchSeconds& more, SearchSeconds& seconds) {
    for (const auto stage : {&SearchSeconds::field, &SearchSeconds::plan, &SearchSeconds::engine,
                             &SearchSeconds::search, &SearchSeconds::read, &SearchSeconds::upload,
                             &SearchSeconds::compute, &SearchSeconds::collect}) {
      seconds.*stage += more.*stage;
    }
  }

  /// The journal of the output file; null for an answer in memory.
  SearchJournal* open_journal() {
    if (file_ && open_ == nullptr) {
      open_ = &file_->journal.open(store_, query_, header_, report_.engine, report_.device);
    }
    return open_;
  }

  std::vector<double> chainage() const {
    return query_.profile > 0 ? chainage_of(query_.poses) : std::vector<double>();
  }

  void publish(const Found& found) {
    const Stopwatch write;
    try {
      static_cast<TableSummary&>(report_) =
          write_result(store_, found.result, header_, file_->pending.partial(), found.write_bytes,
                       progress_, chainage(), options_.threads, findings());
      store_.check_read();
      file_->pending.publish();
    } catch (const ResourceError& error) {
      throw ResourceError(error.what(), Remedy::kResume);
    }
    file_->journal.remove_after_publication();
    report_.cells_read = cells_read_.value_or(store_.cells_touched());
    report_.ignored_looked_at = found.result.ignored_points;
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
  /// The points that collide without floors, where depths need them.
  std::optional<HitSet> without_floors_;
  /// The cells that the searches for points have read, set before beams are followed.
  std::optional<std::uint64_t> cells_read_;
  /// What earlier searches of the same store have read
  const BytesRead bytes_before_ = store_.bytes_read();
  /// The query and the options of a further pass, which outlive its engines.
  struct Further {
    Query query;
    SearchOptions options;
  } further_;
  SearchJournal* open_ = nullptr;
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
