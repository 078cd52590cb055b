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

std::string title_of(const ReportOptions& options) {
  if (!options.title.empty()) return options.title;
  if (options.model_name.empty() || options.environment_name.empty()) return "Clearance report";
  return options.model_name + " through " + options.environment_name;
}

/// Removes all but the largest of the listed groups, of which the page lists no more.
void keep_largest(std::size_t most, UnseenGroups& unseen) {
  if (unseen.listed.size() <= most) return;
  std::vector<std::uint64_t> end, order;  // of the middles of each group; groups by size
  for (const UnseenGroup& group : unseen.listed) {
    order.push_back(end.size());
    end.push_back((end.empty() ? 0 : end.back()) + group.cubes);
  }
  std::ranges::stable_sort(order, std::greater{}, [&](auto k) { return unseen.listed[k].cubes; });
  order.resize(most);
  std::ranges::sort(order);
  std::vector<UnseenGroup> listed;
  std::vector<Vec3> middles;
  for (const std::uint64_t k : order) {
    listed.push_back(unseen.listed[k]);
    const auto last = unseen.middles.begin() + static_cast<std::ptrdiff_t>(end[k]);
    middles.insert(middles.end(), last - static_cast<std::ptrdiff_t>(listed.back().cubes), last);
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
        model_(model),
        poses_(poses),
        how_(options.conflicts),
        progress_(options.conflicts.progress, options.conflicts.stop),
        facts_{.result = result,
               .store = store,
               .options = options,
               .poses = poses,
               .chainage = chainage_of(poses),
               .answer = judged(result, options.warnings),
               .classes = classes_of(result, options.classes),
               .bodies = drawn_bodies(model, poses, options),
               .title = title_of(options),
               .unsearched = unsearched_stretches(poses, options.bodies),
               .searched = searched_length(poses, options.bodies)},
        path_(facts_.bodies) {
    how_.bodies = options.bodies;
    how_.station = options.labels.station;
    facts_.lattice = lattice_for(page_box(path_), kStep);
    facts_.environment_lattice = {facts_.lattice.origin,
                                  std::max(kEnvironmentStep, facts_.lattice.step)};
    facts_.reach = path_.reach();
    facts_.dense_reach = path_.dense_reach();
    if (options.section == nullptr) return;
    picture_.section_name = options.section_name;
    facts_.section.emplace(*options.section, picture_);
  }

  ReportSummary write(const std::filesystem::path& path) {
    ReportSummary summary;
    Answer& answer = facts_.answer;
    find_conflicts_and_points(summary.conflicts);
    if (facts_.conflicts != nullptr) find_stations();
    facts_.unseen = find_unseen_groups(facts_.result, poses_, how_);
    keep_largest(kMostListedConflicts, facts_.unseen);
    profile_ = facts_.result.profile();
    static_cast<TableSummary&>(answer) = facts_.points.summary;
    answer.near_points = facts_.result.reader().near();
    summarise(profile_, answer);
    find_least();
    facts_.environment = sample_environment(facts_.store, path_, facts_.environment_lattice,
                                            facts_.options.max_points, progress_);
    PageContent content{.title = facts_.title,
                        .facts = {},
                        .section = {},
                        .columns = make_columns(summary.conflicts)};
    if (facts_.section) {
      content.section = section_svg(*facts_.section, false);
      facts_.section->add_columns(content.columns);
    }
    content.facts = summary.facts = json_of(facts_);
    summary.verdict = answer.verdict();
    summary.clear = summary.verdict == Verdict::kClear;
    summary.bytes = write_page(path, kReportPage, std::move(content));
    return summary;
  }

 private:
  void find_conflicts_and_points(Conflicts& conflicts) {
    const ReportOptions& options = facts_.options;
    const ResultReader& reader = facts_.result.reader();
    std::vector<std::uint32_t> found_here;
    const std::vector<std::uint32_t>* conflict_of = &found_here;
    if (facts_.result.parameters().first_pose) {
      facts_.conflicts = &conflicts;
      ConflictOptions find = how_;
      if (options.bodies.empty()) find.model = &model_;
      if (found_ != nullptr && found_->are_of(reader.header(), find)) {
        conflicts = found_->conflicts;
        conflict_of = &found_->conflict_of;
      } else {
        conflicts = find_conflicts(facts_.result, poses_, find, &found_here);
      }
    }
    add_warnings(conflict_warnings(conflicts, unit_of(reader.header())), facts_.answer.warnings);
    if (options.shifts) check_shifts(*options.shifts, conflicts, reader);
    if (options.ledger && options.ledger->conflicts.size() != conflicts.listed.size()) {
      throw UsageError("ledger: it judges " +
                       counted(options.ledger->conflicts.size(), "conflict") +
                       ", and the result has " + format_count(conflicts.listed.size()) +
                       "; expected that of these conflicts, found with the same options");
    }
    PointSelection selection{.classes = facts_.classes,
                             .conflicts = &conflicts,
                             .conflict_of = conflict_of,
                             .wanted = {}};
    for (const Conflict& conflict : conflicts.listed) {
      if (conflict.nearest_source) selection.wanted.push_back(*conflict.nearest_source);
    }
    std::ranges::sort(selection.wanted);
    facts_.points = read_shown_points(facts_.result, facts_.lattice, selection, progress_);
  }

  /// The length of the stretches of the table of stations.
  double every() const {
    if (facts_.options.every != 0) return facts_.options.every;
    constexpr double kMostRows = 200;
    const double length = path_length(poses_);
    for (double scale = 5;; scale *= 10) {
      for (const double every : {scale, 2 * scale, 4 * scale}) {
        if (!(length > every * kMostRows)) return every;
      }
    }
  }

  void find_stations() {
    facts_.every = every();
    facts_.stations = station_table(facts_.result, poses_,
                                    {.every = facts_.every,
                                     .chainage_start = how_.chainage_start,
                                     .forward = how_.forward,
                                     .up = how_.up,
                                     .bodies = how_.bodies,
                                     .station = how_.station,
                                     .threads = how_.threads,
                                     .progress = how_.progress,
                                     .stop = how_.stop});
    if (facts_.stations->rows.size() <= kMostStationRowsOfPage) return;
    throw UsageError("a table of " + counted(facts_.stations->rows.size(), "stretch", "stretches") +
                     " of " + format_brief(facts_.every) +
                     " m is too long for a page; expected at least " +
                     format_brief(path_length(poses_) / kMostStationRowsOfPage) + " m");
  }

  /// The cubes of the listed groups, group after group, as many as the page draws.
  std::vector<PagePoint> unseen_points() const {
    const UnseenGroups& unseen = facts_.unseen;
    std::vector<PagePoint> out;
    std::size_t first = 0;
    for (const UnseenGroup& group : unseen.listed) {
      const std::uint64_t shown = shown_cubes(unseen, group);
      for (std::uint64_t i = 0; i < shown; ++i) {
        const Vec3& middle = unseen.middles[first + i * group.cubes / shown];
        out.push_back(page_point(facts_.lattice, middle, 0));
      }
      first += group.cubes;
    }
    return out;
  }

  void find_least() {
    const Answer& answer = facts_.answer;
    const bool has_clearance = answer.least_clearance.has_value();
    const auto& nearest = has_clearance ? answer.least_clearance : answer.least_profile;
    if (!nearest) return;
    LeastDistance& least = facts_.least.emplace();
    static_cast<FoundPlace&>(least) = *nearest;
    least.of = has_clearance ? "clearance" : "profile";
    least.chainage = how_.chainage_start + facts_.chainage[nearest->pose];
    if (!has_clearance && is_vehicle()) least.body_number = nearest_body(*nearest);
    if (has_clearance && !answer.bodies.empty()) least.body_number = nearest->body;
    place(least);
  }

  bool is_vehicle() const { return !how_.bodies.empty(); }

  /// The body that is nearest to a place, because a profile does not say which one it is; none
  /// where no body has a pose.
  std::optional<std::uint32_t> nearest_body(const FoundPlace& place) const {
    std::optional<std::uint32_t> nearest;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < facts_.bodies.size(); ++i) {
      const double distance = facts_.bodies[i].distance_to(place.xyz, place.pose);
      if (!(distance < least)) continue;
      least = distance;
      nearest = i;
    }
    return nearest;
  }

  /// Finds where the nearest point lies, seen from the model or from its body.
  void place(LeastDistance& least) const {
    const DrawnBody& body = facts_.bodies[least.body_number.value_or(0)];
    const Pose* pose = body.pose_at(least.pose);
    if (pose == nullptr) return;
    const Vec3 there = ahead_left_up(least.xyz, *pose, how_.forward, how_.up);
    if (!std::isfinite(there.y) || !std::isfinite(there.z)) return;
    least.side = side_of({there, there}, body.box, how_.forward, how_.up);
    least.lateral = there.y;
    least.height = there.z;
  }

  std::vector<PageColumn> make_columns(const Conflicts& conflicts) {
    std::vector<PageColumn> columns;
    progress_.begin("page", 0, "");
    std::vector<std::uint32_t> named;
    for (const Conflict& conflict : conflicts.listed) {
      named.insert(named.end(), {conflict.first_pose, conflict.last_pose,
                                 conflict.nearest_pose.value_or(conflict.last_pose)});
    }
    for (const UnseenGroup& group : facts_.unseen.listed) named.push_back(group.first_pose);
    if (facts_.least) named.push_back(facts_.least->pose);
    const std::vector<std::uint32_t> shown = choose_poses(poses_.size(), profile_, std::move(named),
                                                          most_shown_poses(facts_.bodies.size()));
    facts_.shown_poses = shown.size();
    const Box box = box_around(facts_.bodies);
    facts_.model_lattice = lattice_for(box, path_.half_diagonal() / 0x1p15);
    facts_.model_lattice.origin = box.centre();
    const std::vector<PagePoint> model =
        points_of_bodies(facts_.bodies, facts_.model_lattice, kMostModelPoints);
    facts_.shown_model_points = model.size();
    append_columns("environment", facts_.environment.points, columns);
    append_columns("points", facts_.points.points, columns);
    append_columns("model", model, columns);
    if (!facts_.unseen.listed.empty()) append_columns("unseen", unseen_points(), columns);
    append_pose_columns(shown, poses_, facts_.chainage, profile_, facts_.options.labels,
                        facts_.lattice, columns);
    if (is_vehicle()) append_body_columns(facts_.bodies, shown, facts_.lattice, columns);
    progress_.end();
    return columns;
  }

  const FoundConflicts* found_;  ///< may be null
  const Model& model_;
  const std::vector<Pose>& poses_;
  ConflictOptions how_;  ///< those of the report, with its bodies and stations
  CallbackProgress progress_;
  SectionPicture picture_;
  ReportFacts facts_;
  PathPlaces path_;
  Profile profile_;
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
