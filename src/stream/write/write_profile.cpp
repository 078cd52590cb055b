#include "stream/write/write_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/query/signed_root.hpp"

namespace clearway {
namespace {

/// Number of poses that are written at a time.
constexpr std::uint64_t kPoses = 1 << 14;

Vec3 position_of(const StoreReader& store, std::uint64_t entry) {
  const auto q = store.coordinates(static_cast<std::uint32_t>(entry / store.cell_entries()));
  const auto i = static_cast<std::uint32_t>(entry % store.cell_entries());
  return position(store.quantisation(), q[0][i], q[1][i], q[2][i]);
}

}  // namespace

std::optional<FoundPlace> write_profile(const StoreReader& store, const ProfileSet& profile,
                                        std::span<const double> chainage, bool is_part,
                                        ResultWriter& writer, Progress& progress) {
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  std::optional<FoundPlace> least;
  std::vector<double> distance;
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;
  std::vector<double> squared;
  for (std::uint64_t first = 0; first < profile.poses(); first += kPoses) {
    throw_if_stopped(progress);
    const std::uint64_t end = std::min(profile.poses(), first + kPoses);
    distance.clear();
    source.clear();
    xyz.clear();
    squared.clear();
    for (std::uint64_t pose = first; pose < end; ++pose) {
      const ProfilePoint& point = profile.at(pose);
      distance.push_back(signed_root(point.squared));
      source.push_back(point.source);
      if (is_part) squared.push_back(point.squared);
      xyz.push_back(point.found() ? position_of(store, point.entry)
                                  : Vec3{kNowhere, kNowhere, kNowhere});
      if (!point.found() || (least && least->distance <= distance.back())) continue;
      least = {point.source, static_cast<std::uint32_t>(pose), xyz.back(), distance.back()};
    }
    writer.append_profile(distance, source, xyz, chainage.subspan(first, end - first), squared);
  }
  return least;
}

}  // namespace clearway
