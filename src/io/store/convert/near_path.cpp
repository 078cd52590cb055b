#include "io/store/convert/near_path.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/paths/trajectory_file.hpp"
#include "io/scans/declared_box.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway {

TrajectoryOptions reading_of_paths(const ConvertOptions& options, const std::string& crs,
                                   LengthUnit unit) {
  const double metres = metres_of(unit);
  TrajectoryOptions how = options.path_options;
  how.lever_arm = {0, 0, 0};
  how.default_crs = crs;
  how.environment_unit = metres > 0 ? metres : 1;
  how.environment_unit_is_assumed = unit == LengthUnit::kUnknown;
  return how;
}

bool is_about_rotation(const Message& remark) {
  for (const char* code : {"rotation-missing", "rotation-too-small", "quaternion-order",
                           "upside-down", "turns-against-path", "model-frame"}) {
    if (remark.code == code) return true;
  }
  return false;
}

Corridor corridor_of(const ConvertOptions& options, const std::string& crs, LengthUnit unit,
                     MessageLog& log) {
  TrajectoryOptions how = reading_of_paths(options, crs, unit);
  how.allow_non_rigid = true;  // only positions count
  const TrajectoryFile file = read_trajectory_file(options.near, how);
  for (const Message& remark : file.remarks) {
    if (!is_about_rotation(remark)) log.add(remark);
  }
  if (file.poses.empty()) refuse(options.near.string(), "has no poses, expected one at least");
  std::vector<Vec3> path;
  for (const Pose& pose : file.poses) {
    const auto& at = pose.translation;
    path.push_back({at[0], at[1], at[2]});
  }
  return Corridor(std::move(path), options.within / how.environment_unit);
}

void refuse_empty_corridor(const ConvertOptions& options, const Corridor& corridor,
                           const std::optional<Box>& whole, std::uint64_t far_points) {
  Box of_path{corridor.path()[0], corridor.path()[0]};
  for (const Vec3& p : corridor.path()) of_path.extend(p);
  refuse(options.near.string(),
         "none of the {} points of the scans is within {} of its path. The path lies in {}, and "
         "the scans in {}; expected a path through the scans, in their unit and coordinate system",
         format_count(far_points), format_number(corridor.within()), declared_box_text(of_path),
         whole ? declared_box_text(*whole) : "no box");
}

}  // namespace clearway
