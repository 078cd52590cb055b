#include "search/counts/report_counts.hpp"

#include <algorithm>

#include "io/result/answer.hpp"

namespace clearway {
void report_sizes(const StoreReader& store, const Query& query, SearchReport& report) {
  report.environment_points = store.point_count();
  report.model_points = query.model.vertices.size();
  report.model_triangles = query.model.triangles.size();
  report.model_solids = solid_count(query);
  report.model_spacing = model_spacing(query);
  report.poses = query.poses.size();
  report.searches = report.poses * query.model.element_count();
  for (const Body& body : query.bodies) {
    report.model_points += body.model.vertices.size();
    report.model_triangles += body.model.triangles.size();
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
  static_cast<Answer&>(report) = answer_of(result);
  report.environment_points = environment_points;
  report.searched = searched;
  report.model_spacing = std::max(report.model_spacing, spacing);
  add_doubts(report.warnings, report);
}

}  // namespace clearway
