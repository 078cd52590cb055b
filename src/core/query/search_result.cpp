#include "core/query/search_result.hpp"

namespace clearway {
namespace {

Body backwards(const Body& body, std::uint32_t last, bool between_poses) {
  Body out = body;
  std::ranges::reverse(out.poses);
  std::ranges::reverse(out.path_pose);
  // A body with a single pose has no way; it counts at the beginning of the way that ends there.
  const bool single = between_poses && out.poses.size() == 1;
  for (std::uint32_t& pose : out.path_pose) {
    pose = last - pose;
    if (single && pose > 0) --pose;
  }
  return out;
}

}  // namespace

void ProfileSet::offer(std::uint32_t pose, double squared, std::uint64_t entry) {
  const std::lock_guard lock(*mutex_);
  ProfilePoint& known = points_[pose];
  ProfilePoint offered{.squared = squared, .entry = entry};
  if (known.squared < squared) return;
  if (known.squared == squared && known.found()) {
    known.source = source_of(known);
    offered.source = source_of(offered);
    if (known.source <= offered.source) return;
  }
  known = offered;
}

std::uint64_t ProfileSet::source_of(const ProfilePoint& point) const {
  if (point.source != ProfilePoint{}.source) return point.source;
  return cloud_->source_of(static_cast<std::uint32_t>(point.entry / cloud_->cell_entries()),
                           static_cast<std::uint32_t>(point.entry % cloud_->cell_entries()));
}

Query backwards(const Query& query) {
  Query out = query;
  out.first_pose = true;
  out.clearance = 0;
  out.profile = 0;
  out.depth = false;
  std::ranges::reverse(out.poses);
  const auto last = static_cast<std::uint32_t>(std::max<std::size_t>(query.poses.size(), 1) - 1);
  for (Body& body : out.bodies) body = backwards(body, last, query.between_poses);
  return out;
}

}  // namespace clearway
