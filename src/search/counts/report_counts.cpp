#include "search/counts/report_counts.hpp"

#include <cmath>

#include "io/result/result_rows.hpp"

namespace clearway {
namespace {

/// distance: of a pose, or its square.
void count_pose(double distance, SearchReport& report) {
  if (!std::isinf(distance)) ++report.profile_poses;
}

}  // namespace

void report_sizes(const StoreReader& store, const Query& query, SearchReport& report) {
  report.environment_points = store.point_count();
  report.model_points = query.model.size();
  report.model_triangles = query.triangles.size();
  report.model_solids = solid_count(query);
  report.poses = query.poses.size();
  report.searches = report.poses * element_count(query);
  for (const Body& body : query.bodies) {
    report.model_points += body.model.size();
    report.model_triangles += body.triangles.size();
    report.searches += body.poses.size() * element_count(body);
  }
  report.cells_total = store.cells().size();
}

void report_finished(const ResultReader& result, SearchReport& report) {
  report.was_finished = true;
  report.colliding_points = result.collisions();
  report.clearance_points = result.clearances();
  ProfileRowStream profile(result);
  for (ProfileRows rows; profile.read(rows);) {
    for (const double distance : rows.distance) count_pose(distance, report);
  }
}

void report_written(const WrittenResult& written, const ProfileSet& profile, SearchReport& report) {
  report.colliding_points = written.collisions;
  report.clearance_points = written.clearances;
  report.inside_points = written.inside_points;
  report.first_place = written.first_place;
  report.least_clearance = written.least_clearance;
  report.least_profile = written.least_profile;
  for (std::uint32_t pose = 0; pose < profile.poses(); ++pose) {
    count_pose(profile.at(pose).squared, report);
  }
}

}  // namespace clearway
