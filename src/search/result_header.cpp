#include "search/result_header.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/geometry/point_box.hpp"
#include "core/query/error_budget.hpp"
#include "core/query/ignored_points.hpp"
#include "io/paths/content_hash.hpp"
#include "io/result/answer.hpp"
#include "search/check_query.hpp"
#include "search/ignored.hpp"

namespace clearway {

namespace {

constexpr double kUsualGap = 0.3;  // metres

std::uint64_t points_of(const Query& query) {
  std::uint64_t points = 0;
  for (const MovingBody& body : moving_bodies(query)) points += body.model.vertices.size();
  return points;
}

std::uint64_t triangles_of(const Query& query) {
  std::uint64_t triangles = 0;
  for (const MovingBody& body : moving_bodies(query)) triangles += body.model.triangles.size();
  return triangles;
}

/// The box around the models of all bodies, each in its own frame.
Box model_box(const Query& query) {
  std::optional<Box> all;
  for (const MovingBody& body : moving_bodies(query)) {
    if (body.model.empty()) continue;
    const Box box = box_of(body.model.vertices);
    all = all ? all->united(box) : box;
  }
  return all.value_or(Box{});
}

std::vector<std::string> names_of(const Query& query) {
  std::vector<std::string> names;
  for (const Body& body : query.bodies) names.push_back(body.name);
  return names;
}

/// The floor of each body; nothing where none has one.
std::vector<std::optional<double>> body_floors(const Query& query) {
  std::vector<std::optional<double>> floors;
  if (query.bodies.empty() || !has_floor(query)) return floors;
  for (const MovingBody& body : moving_bodies(query)) floors.push_back(body.floor);
  return floors;
}

}  // namespace

void choose_gap(QueryParameters& query, double metre) {
  if (query.has_budget() && query.gap == 0) query.gap = kUsualGap * metre;
}

ResultHeader result_header(
    const StoreReader& store, const Query& query, std::span<const std::uint64_t> model_hashes,
    const std::function<IgnoredPointCounts(const QueryParameters& sorted)>& ignored_by) {
  const StoreMetadata& metadata = store.metadata();
  QueryParameters asked = query;
  sort_ignored(asked);
  IgnoredPointCounts ignored = ignored_by(asked);
  choose_gap(asked, metre_of(store));
  ResultHeader header;
  static_cast<QueryParameters&>(header) = std::move(asked);
  header.environment_points = metadata.input_points;
  header.environment_hash = metadata.points_hash;
  header.model_points = points_of(query);
  header.model_hash =
      query.bodies.empty() ? model_hashes.front() : hash_of_bodies(query.bodies, model_hashes);
  header.model_triangles = triangles_of(query);
  header.model_solids = solid_count(query);
  header.model_box = model_box(query);
  header.poses = query.poses.size();
  header.trajectory_hash = hash_of_trajectory(query.poses);
  header.quantisation = metadata.quantisation;
  header.crs_wkt = metadata.crs_wkt;
  header.bodies = names_of(query);
  header.body_floors = body_floors(query);
  header.ignored = std::move(ignored);
  if (metadata.classes) header.classes_hash = metadata.classes->hash;
  header.budget = error_budget_of(query, metadata.quantisation);
  header.notes = {.model_spacing = model_spacing(query),
                  .model_axes = file_axes(query),
                  .length_unit = to_string(metadata.unit)};
  return header;
}

void report_sizes(const StoreReader& store, const Query& query, SearchReport& report) {
  report.environment_points = store.point_count();
  report.model_points = points_of(query);
  report.model_triangles = triangles_of(query);
  report.model_solids = solid_count(query);
  report.model_spacing = model_spacing(query);
  report.poses = query.poses.size();
  for (const MovingBody& body : moving_bodies(query)) {
    report.searches += body.poses.size() * body.model.element_count();
  }
  report.searched = searched_length(query.poses, query.bodies);
  report.cells_total = store.cells().size();
}

void report_finished(const ResultReader& result, SearchReport& report) {
  report.was_finished = true;
  // The count of environment points in a result's header includes those with NaN.
  const std::uint64_t environment_points = report.environment_points;
  // These are missing in some result files.
  const double spacing = report.model_spacing;
  const std::optional<SearchedLength> searched = report.searched;
  const std::vector<Message> warnings = std::move(report.warnings);
  static_cast<Answer&>(report) = answer_of(result);
  report.environment_points = environment_points;
  report.searched = searched;
  report.model_spacing = std::max(report.model_spacing, spacing);
  add_warnings(warnings, report.warnings);
}

}  // namespace clearway
