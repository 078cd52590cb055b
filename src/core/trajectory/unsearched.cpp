#include "clearway/unsearched.hpp"

#include <algorithm>
#include <bitset>
#include <cstddef>

#include "core/trajectory/chainage.hpp"

namespace clearway {
namespace {

using BodySet = std::bitset<kMostBodies>;

/// For each pose of the path, the bodies that have no pose there; empty if every body has every
/// pose.
std::vector<BodySet> missing_at(std::size_t poses, std::span<const Body> bodies) {
  std::vector<BodySet> missing;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::vector<std::uint32_t>& there = bodies[b].path_pose;
    if (there.size() == poses) continue;
    if (missing.empty()) missing.resize(poses);
    std::size_t next = 0;
    for (std::size_t i = 0; i < poses; ++i) {
      if (next < there.size() && there[next] == i) {
        ++next;
      } else {
        missing[i].set(b);
      }
    }
  }
  return missing;
}

std::vector<std::uint32_t> members_of(const BodySet& set) {
  std::vector<std::uint32_t> members;
  for (std::uint32_t b = 0; b < set.size(); ++b) {
    if (set.test(b)) members.push_back(b);
  }
  return members;
}

}  // namespace

std::vector<UnsearchedStretch> unsearched_stretches(std::span<const Pose> path,
                                                    std::span<const Body> bodies) {
  std::vector<UnsearchedStretch> stretches;
  const std::vector<BodySet> missing = missing_at(path.size(), bodies);
  if (missing.empty()) return stretches;
  const std::vector<double> chainage = chainage_of(path);
  BodySet before;  // bodies missing on the way that ends at pose i
  for (std::uint32_t i = 0; i + 1 < path.size(); ++i) {
    const BodySet set = missing[i] | missing[i + 1];
    if (set.none()) {
      before = set;
      continue;
    }
    if (set != before) {
      stretches.push_back({.first_pose = missing[i].any() ? i : i + 1,
                           .chainage_from = chainage[i],
                           .bodies = members_of(set),
                           .has_answer = set.count() < bodies.size()});
    }
    stretches.back().last_pose = missing[i + 1].any() ? i + 1 : i;
    stretches.back().chainage_to = chainage[i + 1];
    before = set;
  }
  return stretches;
}

std::vector<std::array<std::uint32_t, 2>> poses_without_bodies(std::size_t path_poses,
                                                               std::span<const Body> bodies) {
  std::vector<std::array<std::uint32_t, 2>> runs;
  const std::vector<BodySet> missing = missing_at(path_poses, bodies);
  for (std::uint32_t i = 0; i < missing.size(); ++i) {
    if (missing[i].count() < bodies.size()) continue;
    if (runs.empty() || runs.back()[1] + 1 < i) runs.push_back({i, i});
    runs.back()[1] = i;
  }
  return runs;
}

SearchedLength searched_length(std::span<const Pose> path, std::span<const Body> bodies) {
  const std::vector<double> chainage = chainage_of(path);
  SearchedLength length;
  length.path = chainage.empty() ? 0 : chainage.back();
  length.whole = length.path;
  for (const UnsearchedStretch& stretch : unsearched_stretches(path, bodies)) {
    const double metres = stretch.chainage_to - stretch.chainage_from;
    length.whole -= metres;
    if (stretch.has_answer) length.part += metres;
  }
  // Sums of stretches that fill the path may differ from its length by roundings.
  length.whole = std::max(length.whole, 0.0);
  length.part = std::min(length.part, length.path);
  return length;
}

}  // namespace clearway
