#include "report/write_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "clearway/error.hpp"
#include "core/geometry/point_box.hpp"
#include "core/messages/messages.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "core/util/progress.hpp"
#include "findings/check_conflicts.hpp"
#include "findings/touched_first.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/thread_limit.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/shift_file.hpp"
#include "io/result/result.hpp"
#include "io/scans/length_unit.hpp"
#include "io/store/store_reader.hpp"
#include "report/drawn_bodies.hpp"
#include "report/environment_sample.hpp"
#include "report/page.hpp"
#include "report/path_places.hpp"
#include "report/report_facts.hpp"
#include "report/section_view.hpp"
#include "report/shown_points.hpp"
#include "report/shown_poses.hpp"

namespace clearway {
namespace {

/// Throws InputError where a section is that of another environment or path than the result's.
void check_section(const ResultHeader& header, const SectionData& section) {
  const bool same_store = section.environment_hash == header.environment_hash;
  if (same_store && section.trajectory_hash == header.trajectory_hash) return;
  throw InputError(std::string("the section was found for another ") +
                       (same_store ? "trajectory" : "environment") + " than the result",
                   same_store ? Remedy::kSameTrajectory : Remedy::kSameEnvironment);
}

constexpr std::size_t kMostModelPoints = 200'000;
/// Steps in metres of the lattices of the points on the page.
constexpr double kStep = 1e-3, kEnvironmentStep = 2e-3;

std::vector<double> classes_of(const Result& result, const std::vector<double>& asked) {
  const QueryParameters& query = result.parameters();
  if (asked.empty()) {
    if (query.clearance > query.radius) return {query.radius, query.clearance};
    return {query.radius};
  }
  if (asked.size() > ShownPoints::kMostClasses ||
      !std::ranges::is_sorted(asked, std::less_equal{})) {
    throw UsageError("classes: expected one to three distances, each larger than the one before");
  }
  if (asked.back() < query.radius) {
    throw UsageError("classes: the last is " + format_length(asked.back()) +
                     ", below the radius of " + format_length(query.radius) +
                     "; expected at least the radius, so that every colliding point is in a class");
  }
  for (const double below : asked) {
    if (below <= query.clearance || below == query.radius) continue;
    throw UsageError("classes: the result has no distances up to " + format_length(below) +
                         ", only clearances below " + format_length(query.clearance),
                     Remedy::kAskForClearance);
  }
  return asked;
}

/// The box around everything that has a place on the page.
Box page_box(const PathPlaces& path) {
  if (path.places().empty()) return {};
  Box box{path.places()[0].centre, path.places()[0].centre};
  for (const auto& place : path.places()) {
    box = box.united(Box{place.centre, place.centre}.grown(path.reach()));
  }
  return box;
}

/// The answer of the result, with its own warnings and those that were given with it.
Answer judged(const Result& result, const std::vector<Message>& warnings) {
  Answer answer = counted_answer(result.reader());
  add_warnings(warnings, answer.warnings);
  return answer;
}

/// Removes all but the largest of the listed groups, of which the page lists no more.
void keep_largest(std::size_t most, UnseenGroups& unseen) {
  if (unseen.listed.size() <= most) return;
  std::vector<std::uint32_t> order;
  for (std::uint32_t k = 0; k < unseen.listed.size(); ++k) order.push_back(k);
  std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return unseen.listed[a].cubes > unseen.listed[b].cubes;
  });
  std::vector<bool> kept(order.size());
  for (std::size_t k = 0; k < most; ++k) kept[order[k]] = true;
  std::vector<UnseenGroup> listed;
  std::vector<Vec3> middles;
  auto next = unseen.middles.begin();
  for (std::size_t k = 0; k < unseen.listed.size(); ++k) {
    const auto end = next + static_cast<std::ptrdiff_t>(unseen.listed[k].cubes);
    if (kept[k]) middles.insert(middles.end(), next, end);
    if (kept[k]) listed.push_back(unseen.listed[k]);
    next = end;
  }
  unseen.listed = std::move(listed);
  unseen.middles = std::move(middles);
}

/// One call of write_report(), step by step.
class Report {
 public:
  /// The most rows of the table of stations that a page takes.
  static constexpr std::size_t kMostStationRowsOfPage = 5000;

  Report(const Result& result, const Store& store, const Model& model,
         const std::vector<Pose>& poses, const ReportOptions& options, const FoundConflicts* found)
      : found_(found),
        result_(result),
        answer_(judged(result, options.warnings)),
        store_(store),
        model_(model),
        poses_(poses),
        options_(options),
        progress_(options.conflicts.progress, options.conflicts.stop),
        classes_(classes_of(result, options.classes)),
        bodies_(drawn_bodies(model, poses, options)),
        model_box_(box_around(bodies_)),
        path_(bodies_),
        lattice_(lattice_for(page_box(path_), kStep)) {
    if (options.section == nullptr) return;
    picture_.section_name = options.section_name;
    section_.emplace(*options.section, picture_);
  }

  ReportSummary write(const std::filesystem::path& path) {
    ReportSummary summary;
    find_conflicts_and_points(summary.conflicts);
    find_stations();
    find_unseen();
    profile_ = result_.profile();
    static_cast<TableSummary&>(answer_) = points_.summary;
    answer_.near_points = result_.reader().near();
    summarise(profile_, answer_);
    find_least();
    environment_lattice_.step = std::max(kEnvironmentStep, lattice_.step);
    environment_lattice_.origin = lattice_.origin;
    environment_ =
        sample_environment(store_, path_, environment_lattice_, options_.max_points, progress_);
    PageContent content{.title = title(), .facts = {}, .section = {}, .columns = {}};
    content.columns = make_columns(summary.conflicts);
    if (section_) {
      content.section = section_svg(*section_, false);
      section_->add_columns(content.columns);
    }
    content.facts = summary.facts = facts(summary.conflicts);
    summary.verdict = answer_.verdict();
    summary.clear = summary.verdict == Verdict::kClear;
    summary.bytes = write_page(path, PageKind::kReport, content);
    return summary;
  }

 private:
  std::string title() const {
    if (!options_.title.empty()) return options_.title;
    if (options_.model_name.empty() || options_.environment_name.empty()) return "Clearance report";
    return options_.model_name + " through " + options_.environment_name;
  }

  void find_conflicts_and_points(Conflicts& conflicts) {
    std::vector<std::uint32_t> found_here;
    const std::vector<std::uint32_t>* conflict_of = &found_here;
    if (result_.parameters().first_pose) {
      ConflictOptions find = options_.conflicts;
      find.bodies = options_.bodies;
      find.station = options_.labels.station;
      if (options_.bodies.empty()) find.model = &model_;
      if (found_ != nullptr && found_->are_of(result_.reader().header(), find)) {
        conflicts = found_->conflicts;
        conflict_of = &found_->conflict_of;
      } else {
        conflicts = find_conflicts(result_, poses_, find, &found_here);
      }
    }
    add_warnings(conflict_warnings(conflicts, unit_of(result_.reader().header())),
                 answer_.warnings);
    if (options_.shifts) check_shifts(*options_.shifts, conflicts, result_.reader());
    if (options_.ledger && options_.ledger->conflicts.size() != conflicts.listed.size()) {
      throw UsageError("ledger: it judges " +
                       counted(options_.ledger->conflicts.size(), "conflict") +
                       ", and the result has " + format_count(conflicts.listed.size()) +
                       "; expected that of these conflicts, found with the same options");
    }
    PointSelection selection{
        .classes = classes_, .conflicts = &conflicts, .conflict_of = conflict_of, .wanted = {}};
    for (const Conflict& conflict : conflicts.listed) {
      if (conflict.nearest_source) selection.wanted.push_back(*conflict.nearest_source);
    }
    std::ranges::sort(selection.wanted);
    points_ = read_shown_points(result_, lattice_, selection, progress_);
  }

  /// The length of the stretches of the table of stations.
  double every() const {
    if (options_.every != 0) return options_.every;
    constexpr double kMostRows = 200;
    const double length = path_length(poses_);
    for (double scale = 5;; scale *= 10) {
      for (const double every : {scale, 2 * scale, 4 * scale}) {
        if (!(length > every * kMostRows)) return every;
      }
    }
  }

  void find_stations() {
    if (!result_.parameters().first_pose) return;
    every_ = every();
    StationOptions how;
    how.every = every_;
    how.chainage_start = options_.conflicts.chainage_start;
    how.forward = options_.conflicts.forward;
    how.up = options_.conflicts.up;
    how.bodies = options_.bodies;
    how.station = options_.labels.station;
    how.threads = options_.conflicts.threads;
    how.progress = options_.conflicts.progress;
    how.stop = options_.conflicts.stop;
    stations_ = station_table(result_, poses_, how);
    if (stations_->rows.size() <= kMostStationRowsOfPage) return;
    throw UsageError("a table of " + counted(stations_->rows.size(), "stretch", "stretches") +
                     " of " + format_brief(every_) +
                     " m is too long for a page; expected at least " +
                     format_brief(path_length(poses_) / kMostStationRowsOfPage) + " m");
  }

  void find_unseen() {
    ConflictOptions how = options_.conflicts;
    how.bodies = options_.bodies;
    unseen_ = find_unseen_groups(result_, poses_, how);
    keep_largest(kMostListedConflicts, unseen_);
  }

  /// The cubes of the listed groups, group after group, as many as the page draws.
  std::vector<PagePoint> unseen_points() const {
    std::vector<PagePoint> out;
    std::size_t first = 0;
    for (const UnseenGroup& group : unseen_.listed) {
      const std::uint64_t shown = shown_cubes(unseen_, group);
      for (std::uint64_t i = 0; i < shown; ++i) {
        out.push_back(page_point(lattice_, unseen_.middles[first + i * group.cubes / shown], 0));
      }
      first += group.cubes;
    }
    return out;
  }

  void find_least() {
    chainage_ = chainage_of(poses_);
    const bool has_clearance = answer_.least_clearance.has_value();
    const auto& nearest = has_clearance ? answer_.least_clearance : answer_.least_profile;
    if (!nearest) return;
    least_of_ = has_clearance ? "clearance" : "profile";
    least_ = {.distance = nearest->distance,
              .pose = nearest->pose,
              .source = nearest->source,
              .xyz = nearest->xyz,
              .point_class = nearest->point_class};
    if (!has_clearance && is_vehicle()) find_nearest_body();
    if (has_clearance && !answer_.bodies.empty()) least_->body = nearest->body;
    place_least();
  }

  bool is_vehicle() const { return !options_.bodies.empty(); }

  /// Finds the body that is nearest, because a profile does not say which one it is.
  void find_nearest_body() {
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
      const double distance = bodies_[i].distance_to(*least_->xyz, least_->pose);
      if (!(distance < least)) continue;
      least = distance;
      least_->body = i;
    }
  }

  /// Finds where the nearest point lies, seen from the model or from its body.
  void place_least() {
    if (!least_->xyz) return;
    const ConflictOptions& how = options_.conflicts;
    const DrawnBody& body = bodies_[least_->body.value_or(0)];
    const Pose* pose = body.pose_at(least_->pose);
    if (pose == nullptr) return;
    const Vec3 there = ahead_left_up(*least_->xyz, *pose, how.forward, how.up);
    if (!std::isfinite(there.y) || !std::isfinite(there.z)) return;
    least_->side = side_of({there, there}, body.box, how.forward, how.up);
    least_->lateral = there.y;
    least_->height = there.z;
  }

  std::vector<PageColumn> make_columns(const Conflicts& conflicts) {
    std::vector<PageColumn> columns;
    progress_.begin("page", 0, "");
    shown_ =
        choose_poses(poses_.size(), profile_, conflicts.listed, most_shown_poses(bodies_.size()));
    if (least_) shown_.push_back(least_->pose);
    for (const UnseenGroup& group : unseen_.listed) shown_.push_back(group.first_pose);
    std::ranges::sort(shown_);
    shown_.erase(std::unique(shown_.begin(), shown_.end()), shown_.end());
    model_lattice_ = lattice_for(model_box_, path_.half_diagonal() / 0x1p15);
    model_lattice_.origin = box_centre_at(model_box_, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {}});
    const std::vector<PagePoint> model =
        points_of_bodies(bodies_, model_lattice_, kMostModelPoints);
    shown_model_points_ = model.size();
    append_columns("environment", environment_.points, columns);
    append_columns("points", points_.points, columns);
    append_columns("model", model, columns);
    if (!unseen_.listed.empty()) append_columns("unseen", unseen_points(), columns);
    append_pose_columns(shown_, poses_, chainage_, profile_, options_.labels, lattice_, columns);
    if (is_vehicle()) append_body_columns(bodies_, shown_, lattice_, columns);
    progress_.end();
    return columns;
  }

  std::string facts(const Conflicts& conflicts) const {
    return json_of(ReportFacts{
        .result = result_,
        .answer = answer_,
        .store = store_,
        .options = options_,
        .poses = poses_,
        .title = title(),
        .model_box = model_box_,
        .bodies = bodies_,
        .classes = classes_,
        .unsearched = unsearched_stretches(poses_, options_.bodies),
        .searched = searched_length(poses_, options_.bodies),
        .conflicts = result_.parameters().first_pose ? &conflicts : nullptr,
        .section = section_ ? &*section_ : nullptr,
        .stations = stations_ ? &*stations_ : nullptr,
        .every = every_,
        .unseen = unseen_,
        .points = points_,
        .environment = environment_,
        .reach = path_.reach(),
        .dense_reach = path_.dense_reach(),
        .shown_poses = shown_.size(),
        .shown_model_points = shown_model_points_,
        .least = least_,
        .least_chainage = least_ ? options_.conflicts.chainage_start + chainage_[least_->pose] : 0,
        .least_of = least_of_,
        .lattice = lattice_,
        .environment_lattice = environment_lattice_,
        .model_lattice = model_lattice_});
  }

  const FoundConflicts* found_;  ///< may be null
  const Result& result_;
  Answer answer_;
  const Store& store_;
  const Model& model_;
  const std::vector<Pose>& poses_;
  const ReportOptions& options_;
  CallbackProgress progress_;
  std::vector<double> classes_;
  std::vector<DrawnBody> bodies_;
  Box model_box_;
  PathPlaces path_;
  PageLattice lattice_, environment_lattice_, model_lattice_;
  ShownPoints points_;
  EnvironmentSample environment_;
  Profile profile_;
  std::optional<StationTable> stations_;
  double every_ = 0;
  UnseenGroups unseen_;
  SectionPicture picture_;
  std::optional<SectionView> section_;
  std::vector<double> chainage_;
  std::vector<std::uint32_t> shown_;
  std::size_t shown_model_points_ = 0;
  std::optional<LeastDistance> least_;
  const char* least_of_ = nullptr;
};

}  // namespace

ReportSummary write_report(const Result& result, const Store& store, const Model& model,
                           const std::vector<Pose>& poses, const std::filesystem::path& output,
                           const ReportOptions& options) {
  return write_report(result, store, model, poses, output, options, nullptr);
}

ReportSummary write_report(const Result& result, const Store& store, const Model& model,
                           const std::vector<Pose>& poses, const std::filesystem::path& output,
                           const ReportOptions& options, const FoundConflicts* found) {
  check_axes(result.reader(), options.conflicts);
  check_searched(result.reader(), store.reader(), {model, options.bodies, poses});
  if (options.section != nullptr) {
    check_section(result.reader().header(), options.section->data());
  }
  PendingFile file(output, options.overwrite);
  ReportSummary summary;
  in_threads(options.conflicts.threads, [&] {
    summary = Report(result, store, model, poses, options, found).write(file.partial());
  });
  file.publish();
  return summary;
}

}  // namespace clearway
