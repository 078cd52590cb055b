#include "report/shown_poses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

namespace clearway {
namespace {

/// Adds a column of numbers: number(item) for each item.
template <typename Items, typename Number>
void add_numbers(std::string name, const Items& items, const Number& number,
                 std::vector<PageColumn>& columns) {
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  std::vector<std::int32_t> values;
  values.reserve(items.size());
  for (const auto& item : items) {
    const double value = number(item);
    values.push_back(static_cast<std::int32_t>(std::clamp(std::round(value), -kMost, kMost)));
  }
  columns.push_back({std::move(name), delta_planes(values)});
}

/// Adds the places of poses as NAME.x to NAME.z, and their rotations as NAME.r0 to NAME.r8; zeros
/// where there is no pose.
void add_places(const std::string& name, std::span<const Pose* const> poses,
                const PageLattice& lattice, std::vector<PageColumn>& columns) {
  for (int k = 0; k < 3; ++k) {
    const auto place = [&](const Pose* pose) {
      return pose ? (pose->translation[k] - lattice.origin[k]) / lattice.step : 0;
    };
    add_numbers(name + "." + "xyz"[k], poses, place, columns);
  }
  for (int k = 0; k < 9; ++k) {
    const auto turn = [&](const Pose* pose) {
      return pose ? pose->rotation[k] / kRotationStep : 0;
    };
    add_numbers(name + ".r" + std::to_string(k), poses, turn, columns);
  }
}

void add_profile(std::span<const std::uint32_t> shown, const Profile& profile,
                 const PageLattice& lattice, std::vector<PageColumn>& columns) {
  const auto distance = [&](std::uint32_t i) {
    return std::isfinite(profile.distance[i]) ? profile.distance[i] / kDistanceStep : kNoDistance;
  };
  add_numbers("pose.distance", shown, distance, columns);
  for (int k = 0; k < 3; ++k) {
    const auto place = [&](std::uint32_t i) {
      if (profile.source[i] == Profile::kNoPoint) return 0.0;
      return (profile.xyz[i][k] - lattice.origin[k]) / lattice.step;
    };
    add_numbers(std::string("pose.p") + "xyz"[k], shown, place, columns);
  }
}

/// A text for each shown pose, in lines.
std::string lines_of(std::span<const std::uint32_t> shown, const std::vector<std::string>& texts) {
  std::string out;
  for (const std::uint32_t i : shown) {
    for (const char c : texts[i]) out += c == '\n' ? ' ' : c;
    out += '\n';
  }
  return out;
}

}  // namespace

double origin_on_page(const PoseLabel<double>& label, const std::vector<double>& values) {
  return label.is_counted_from_first ? values.front() : 0;
}

std::vector<std::uint32_t> choose_poses(std::uint64_t poses, const Profile& profile,
                                        std::vector<std::uint32_t> named, std::size_t most) {
  if (poses == 0) return {};
  std::vector<std::uint32_t> shown = std::move(named);
  const std::uint64_t stretches = std::min<std::uint64_t>(poses, most);
  for (std::uint64_t k = 0; k < stretches; ++k) {
    std::uint64_t best = k * poses / stretches;
    for (std::uint64_t i = best + 1; i < (k + 1) * poses / stretches; ++i) {
      if (!profile.distance.empty() && profile.distance[i] < profile.distance[best]) best = i;
    }
    shown.push_back(static_cast<std::uint32_t>(best));
  }
  shown.push_back(0);
  shown.push_back(static_cast<std::uint32_t>(poses - 1));
  std::ranges::sort(shown);
  shown.erase(std::unique(shown.begin(), shown.end()), shown.end());
  return shown;
}

void append_pose_columns(std::span<const std::uint32_t> shown, std::span<const Pose> poses,
                         std::span<const double> chainage, const Profile& profile,
                         const PoseLabels& labels, const PageLattice& lattice,
                         std::vector<PageColumn>& columns) {
  const auto index = [](std::uint32_t i) { return i; };
  std::vector<const Pose*> there;
  for (const std::uint32_t i : shown) there.push_back(&poses[i]);
  add_numbers("pose.index", shown, index, columns);
  add_places("pose", there, lattice, columns);
  const auto along = [&](std::uint32_t i) { return chainage[i] / kChainageStep; };
  add_numbers("pose.chainage", shown, along, columns);
  if (!profile.distance.empty()) add_profile(shown, profile, lattice, columns);
  for_each_label([&](const auto& label) {
    const auto& values = label.of(labels);
    if (values.empty()) return;
    const std::string name = std::string("pose.") + label.key;
    if constexpr (std::decay_t<decltype(label)>::is_text()) {
      columns.push_back({name, lines_of(shown, values)});
    } else {
      const double origin = origin_on_page(label, values);
      const auto steps = [&](std::uint32_t i) { return (values[i] - origin) / kLabelStep; };
      add_numbers(name, shown, steps, columns);
    }
  });
}

void append_body_columns(std::span<const DrawnBody> bodies, std::span<const std::uint32_t> shown,
                         const PageLattice& lattice, std::vector<PageColumn>& columns) {
  std::vector<const Pose*> there;
  for (const DrawnBody& body : bodies) {
    for (const std::uint32_t i : shown) there.push_back(body.pose_at(i));
  }
  const auto is_there = [](const Pose* pose) { return pose == nullptr ? 0 : 1; };
  add_numbers("body.there", there, is_there, columns);
  add_places("body", there, lattice, columns);
}

}  // namespace clearway
