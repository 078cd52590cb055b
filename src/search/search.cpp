#include "clearway/search.hpp"

#include <algorithm>
#include <deque>
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

/// What a search has found, and what its last visit has left.
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

  /// The questions that visits answer, those about all points first. What is known without a search
  /// is not among them.
  std::vector<PointQuestion> visited_questions() const {
    using enum PointQuestion;
    std::vector<PointQuestion> questions{kHits};
    if (report_.ignored.points > 0) questions.push_back(kIgnored);
    if (header_.budget && near_radius() > query_.radius) questions.push_back(kNear);
    if (has_floor(query_)) questions.push_back(kBelow);
    // The last of a single pose is the first one.
    if (query_.first_pose && query_.poses.size() > 1) questions.push_back(kLast);
    if (header_.budget && certain_radius() < query_.radius &&
        (certain_radius() > 0 || has_solids(query_))) {
      questions.push_back(kCertain);
    }
    return questions;
  }

  /// Searches all that the query asks for. Only the last visit ends the GPUs.
  AllFound find_all() {
    const bool end_gpus = std::exchange(options_.end_gpus, false);
    choose_device();
    look_at_ground();
    const std::vector<PointQuestion> questions = visited_questions();
    // A question with further searches has all the memory, because these need some of their own.
    if (query_.ignores_points() || query_.has_budget() || query_.seen || query_.depth ||
        has_floor(query_)) {
      take_memory(~0ULL);
    }
    AllFound found;
    if (query_.profile > 0) found.profile = ProfileSet(store_, query_.poses.size());
    // A GPU that the user did not ask for is given up for the CPU only before the journal is open.
    found.end = engines_.on(
        report_.device,
        [&](Device device) {
          return visit_all(device, questions, end_gpus && !query_.seen, found.profile);
        },
        [&](const ResourceError&) {
          if (journal_ != nullptr) throw;
        });
    if (file_) report_.resumed_cells = file_->journal.earlier_cells();
    found.rows = rows_;
    report_points();
    options_.end_gpus = end_gpus;
    if (query_.seen) {
      found.end.engine_end.clear();
      find_unseen(found);
    }
    if (query_.depth) find_depths_of(found);
    if (query_.ignores_points()) warn_of_colliding_ignored(report_, store_.metadata().unit, log_);
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

  // Distances from the model, with an error budget: below which a point is certainly too close, and
  // below which it may be.
  double certain_radius() const { return header_.budget->certain_radius(query_.radius); }
  double near_radius() const { return header_.budget->near_radius(query_.radius); }

  /// The distance from the model at which a place counts as swept.
  double swept_radius() const { return header_.budget ? near_radius() : query_.radius; }

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

  void take_memory(std::uint64_t bytes) { memory_.take(bytes, progress_); }

  /// Asks all questions in one visit where there is memory for it, and otherwise one after another.
  /// Leaves in the end of the last visit the memory that is left to write with.
  VisitEnd visit_all(Device device, std::span<const PointQuestion> questions, bool end_gpus,
                     ProfileSet& profile) {
    if (options_.engine == Engine::kSweep && may_join(questions.size())) {
      try {
        return visit(device, questions, end_gpus, profile);
      } catch (const ResourceError& error) {
        if (is_visiting_ || !is_short_of_memory(error)) throw;
      }
    }
    VisitEnd end{.write_bytes = ~std::uint64_t{0}};
    for (; !questions.empty(); questions = questions.subspan(1)) {
      end.engine_end.clear();
      VisitEnd one = visit(device, questions.first(1), end_gpus && questions.size() == 1, profile);
      end = {std::min(end.write_bytes, one.write_bytes), std::move(one.engine_end)};
    }
    return end;
  }

  /// Whether an error says that memory, of the host or of a device, is too little.
  static bool is_short_of_memory(const ResourceError& error) {
    using enum Remedy;
    const Remedy remedy = error.remedy();
    return remedy == kMoreMemory || remedy == kMoreDeviceMemory || remedy == kOtherGpu;
  }

  /// Whether so many questions can be asked in one visit, as far as their inputs alone show: these
  /// are copied before the visit is planned.
  bool may_join(std::size_t questions) const {
    const std::uint64_t inputs = input_bytes(store_, query_);
    const std::uint64_t of_question =
        inputs - store_.allocated_bytes() + tree_building_bytes(query_);
    return questions > 1 && program_bytes(options_.threads) + search_result_bytes(store_, query_) +
                                    inputs + questions * of_question <=
                                options_.memory_bytes;
  }

  /// Asks these questions of all cells that have not been asked all of them, page by page.
  VisitEnd visit(Device device, std::span<const PointQuestion> questions, bool end_gpus,
                 ProfileSet& profile) {
    const PointQuestion first = questions.front();
    const bool is_main = first == PointQuestion::kHits;
    report_.device = device;
    report_.device_name = DeviceChoice().name;
    // A journal that does not match is refused before anything is planned.
    if (is_main && (device == Device::kCpu || !fallback_allowed(options_))) open_rows(profile);
    is_visiting_ = false;
    further_.clear();
    std::vector<VisitQuestion> asked;
    for (const PointQuestion question : questions) {
      const Query& query =
          question == PointQuestion::kHits ? query_ : further_.emplace_back(query_of(question));
      asked.push_back({query, of_whom(question)});
    }
    visit_options_ = options_;
    visit_options_.end_gpus = end_gpus;
    // What the first visit took is enough, except for rounding in the plan.
    if (!is_main) visit_options_.memory_bytes += options_.memory_bytes / 16;
    if (!is_main) visit_options_.engine = Engine::kSweep;
    const bool of_hits = !is_main && asked.front().of == VisitQuestion::Of::kHits;
    const ShardCells with_hits = of_hits ? cells_with(PointQuestion::kHits) : ShardCells({});
    if (of_hits && with_hits.empty()) return {.write_bytes = ~std::uint64_t{0}};
    const auto search = questions.size() > 1               ? IgnoredPoints::Search::kBoth
                        : first == PointQuestion::kIgnored ? IgnoredPoints::Search::kIgnored
                                                           : IgnoredPoints::Search::kOthers;
    const auto kind = engines_.kind(device, store_, asked, visit_options_);
    SearchReport further_report;
    const MessageCallback silent;
    const MessageLog silent_log(silent, further_report.warnings);
    SearchReport& report = is_main ? report_ : further_report;
    CollectPage keep;
    VisitEnd end = run_visit(store_,
                             {.query = asked.front().query,
                              .memory_bytes = visit_options_.memory_bytes,
                              .kind = *kind,
                              .only = of_hits ? &with_hits : only(),
                              .collect = [&](std::span<const PlannedCell> cells,
                                             const PageResult& page) { keep(cells, page); },
                              .answered =
                                  [&](std::uint32_t cell) {
                                    return std::ranges::all_of(questions, [&](PointQuestion one) {
                                      return rows_->answered(cell, one);
                                    });
                                  },
                              .stage = is_main ? "search" : name_of(first),
                              .search = search,
                              .least_write_bytes = least_write_bytes(store_, asked.front().query),
                              .planned =
                                  [&](std::uint64_t host, std::uint64_t on_device) {
                                    if (!is_main) return;
                                    take_memory(host + (file_ ? 0 : kMemoryStep));
                                    engines_.take_device_memory(on_device, progress_);
                                  },
                              .made =
                                  [&] {
                                    is_visiting_ = true;
                                    if (is_main) open_rows(profile);
                                    keep = keeper(questions, profile);
                                  }},
                             progress_, report, is_main ? log_ : silent_log);
    if (!is_main) {
      add_seconds(further_report.seconds, report_.seconds);
      report_.peak_device_bytes =
          std::max(report_.peak_device_bytes, further_report.peak_device_bytes);
    }
    return end;
  }

  static VisitQuestion::Of of_whom(PointQuestion question) {
    using enum PointQuestion;
    if (question == kIgnored) return VisitQuestion::Of::kIgnored;
    return question == kLast || question == kCertain ? VisitQuestion::Of::kHits
                                                     : VisitQuestion::Of::kSearched;
  }

  /// The query that answers a question. Certain points are those that are closer than the certain
  /// radius, which is below that of the query; where it is below 0, they are the points that are
  /// deeper than it inside a solid.
  Query query_of(PointQuestion question) const {
    switch (question) {
      case PointQuestion::kIgnored:
        return plain_query(query_.radius, true);
      case PointQuestion::kNear:
        return plain_query(near_radius(), query_.first_pose);
      case PointQuestion::kLast:
        return backwards(query_);
      case PointQuestion::kCertain: {
        if (certain_radius() > 0) return plain_query(certain_radius(), false);
        Query query = plain_query(query_.radius, false);
        query.clearance = query_.radius;
        raise_floors(query, query_.radius - certain_radius());
        return query;
      }
      default: {
        Query query = plain_query(query_.radius, false);
        query.floor.reset();
        for (Body& body : query.bodies) body.floor.reset();
        return query;
      }
    }
  }

  /// The query without what a further question about points alone does not need. Floors keep their
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

  /// What keeps the pages of a visit that asks these questions.
  CollectPage keeper(std::span<const PointQuestion> questions, ProfileSet& profile) {
    if (std::ranges::count(questions, PointQuestion::kIgnored) > 0) {
      above_ground_ = above_ground(store_, query_);
    }
    if (questions.front() != PointQuestion::kHits) {
      return [this, question = questions.front()](std::span<const PlannedCell> cells,
                                                  const PageResult& page) {
        for (std::size_t i = 0; i < cells.size(); ++i) {
          std::vector<AnswerRows::Part> parts;
          add_rows(
              question, cells[i].cell, page, i,
              [&] { return rows_->read(cells[i].cell, PointQuestion::kHits); }, parts);
          rows_->add(cells[i].cell, parts);
        }
      };
    }
    return keep_answer(store_, *rows_, profile, journal_,
                       [this, questions](std::uint32_t cell, const PageResult& page,
                                         std::size_t index, std::vector<AnswerRows::Part>& parts) {
                         const CellRows hits{.words = parts.front().rows.words};
                         for (std::size_t i = 1; i < questions.size(); ++i) {
                           add_rows(
                               questions[i], cell, page.further[i - 1], index,
                               [&]() -> const CellRows& { return hits; }, parts);
                         }
                         // Without errors in the way, all that collide are certain.
                         if (header_.budget && !(certain_radius() < query_.radius)) {
                           parts.push_back({PointQuestion::kCertain, hits});
                         }
                       });
  }

  /// Adds what a page says to a question about cell `index` of it. hits(): returns the points of
  /// the cell that collide; called only if they are needed.
  template <typename Hits>
  void add_rows(PointQuestion question, std::uint32_t cell, const PageResult& page,
                std::size_t index, const Hits& hits, std::vector<AnswerRows::Part>& parts) const {
    CellRows found = hit_rows(store_, page, index);
    if (question == PointQuestion::kNear || question == PointQuestion::kBelow) {
      found = without(found, hits());
    } else if (question == PointQuestion::kIgnored) {
      parts.push_back(
          {PointQuestion::kIgnoredHigh, high_points(store_, query_, above_ground_, cell, found)});
      found.poses.clear();
    } else if (question == PointQuestion::kCertain && !(certain_radius() > 0)) {
      const double deeper = -(certain_radius() * certain_radius());
      const CellRows clearances = clearance_rows(store_, page, index);
      const CellRows& colliding = hits();
      found = points_where(clearances, [&](std::uint32_t point, std::size_t row) {
        return clearances.distances[row] < deeper && colliding.contains(point);
      });
    }
    parts.push_back({question, std::move(found)});
  }

  /// The cells in which a question has found points.
  ShardCells cells_with(PointQuestion question) const {
    std::vector<bool> in(store_.cells().size());
    for (const std::uint32_t cell : rows_->cells(question)) in[cell] = true;
    return ShardCells(std::move(in));
  }

  /// Reports how many points the questions have found. Below the floor those count that are neither
  /// colliding nor near.
  void report_points() {
    using enum PointQuestion;
    if (query_.ignores_points()) report_.colliding_points = rows_->points(kHits);
    report_.ignored_colliding = rows_->points(kIgnored);
    report_.ignored_colliding_high = rows_->points(kIgnoredHigh);
    if (header_.budget) report_.certain = certain_group();
    if (!has_floor(query_)) return;
    std::uint64_t below = header_.budget ? 0 : rows_->points(kBelow);
    if (header_.budget) {
      for (const std::uint32_t cell : rows_->cells(kBelow)) {
        below += without(rows_->read(cell, kBelow), rows_->read(cell, kNear)).count();
      }
    }
    report_.floor_colliding = below;
  }

  /// Whether enough of the certain points hang together.
  CertainPoints certain_group() {
    CertainGroup group(store_.quantisation(), header_.gap, progress_);
    ThreadLimit(options_.threads).run([&] {
      for (const std::uint32_t cell : rows_->cells(PointQuestion::kCertain)) {
        const auto q = store_.coordinates(cell);
        rows_->read(cell, PointQuestion::kCertain).for_each([&](std::uint32_t i, std::size_t) {
          group.add({q[0][i], q[1][i], q[2][i]});
        });
      }
    });
    return group.found();
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
    visit_options_ = options_;
    visit_options_.engine = Engine::kSweep;
    visit_options_.end_gpus = false;  // following the beams does
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
                         return engines_.kind(device, cloud, {{query}}, visit_options_);
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
  std::deque<Query> further_;    ///< those of a visit besides the query, which outlive its engines
  SearchOptions visit_options_;  ///< those of a visit
  bool is_visiting_ = false;     ///< whether a visit has begun to search
  double above_ground_ = 0;      ///< above_ground(), once ignored points are searched
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
