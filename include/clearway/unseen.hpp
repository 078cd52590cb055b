#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/pose.hpp"
#include "clearway/result.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// Cubes that the model sweeps, that no beam passed through, and that touch each other by a face,
/// an edge or a corner, directly or through others. Something can stand there unnoticed.
struct UnseenGroup {
  std::uint32_t id = 0;     ///< its number in UnseenCubes::group
  std::uint64_t cubes = 0;  ///< number of its cubes
  Box box{};                ///< box around its cubes, metres
  Vec3 middle{};            ///< middle of its cube that is nearest to the mean of all, metres
  /// The least and the greatest first pose of its cubes.
  std::uint32_t first_pose = 0, last_pose = 0;
  /// Chainage of first_pose and of the pose after last_pose, metres along the path.
  double chainage_from = 0, chainage_to = 0;
  /// The side of the model on which those of its cubes lie that the model reaches at first_pose.
  Side side = Side::kUnknown;
  /// The box around the middles of its cubes, each seen from the pose of the path that first
  /// reaches it: metres ahead, to the left, and up. None where no such pose can be inverted.
  std::optional<Box> seen = {};
  /// Whether a colliding point lies in one of its cubes or in a cube that touches one of them. What
  /// collides may then hide the group from the scanner.
  bool behind_conflict = false;
  /// Whether the model reaches the group along more than half of the path.
  bool along_path = false;
  /// Whether the group goes along the path, is about as wide as the model, and reaches down to its
  /// lowest points. Its lower part is then usually the ground on which the vehicle stands.
  bool is_ground = false;
  /// Whether the group goes along the path in the upper half of the model. No beam comes back from
  /// the open sky.
  bool is_sky = false;
};

/// How much is unseen in each place of the vehicle's cross-section, seen along its path: cells of a
/// grid that looks forward, so that left is positive, row by row from below, and within a row
/// towards the left.
struct UnseenFront {
  double cell = 0;  ///< side of a cell, metres: a multiple of a cube's side
  std::uint32_t columns = 0, rows = 0;
  double left = 0, up = 0;  ///< the least corner of the first cell, metres from the path
  /// How far each cell is swept, metres: the volume of the cubes that the model first reaches
  /// there, divided by the area of the cell.
  std::vector<double> swept;
  /// How far each cell is unseen, metres: likewise of the unseen cubes, so at most `swept`.
  std::vector<double> unseen;
};

/// Where the model passes through space that no beam of the scanner reached.
struct UnseenGroups {
  /// Groups of at least QueryParameters::seen_min cubes, in the order of their ids.
  std::vector<UnseenGroup> listed;
  std::uint64_t small_groups = 0, small_cubes = 0;  ///< numbers of the other groups and their cubes
  std::uint64_t behind_conflicts = 0;  ///< number of listed groups that are behind a conflict
  /// Stretches of the path, from and to in metres of chainage, on which the model first reaches a
  /// cube of a listed group. Gaps that are shorter than a cube are closed.
  std::vector<std::pair<double, double>> stretches;
  UnseenFront front;
  /// Middles of the cubes of the listed groups, group after group in the order of the list.
  std::vector<Vec3> middles;
  double path_length = 0;  ///< length of the path, metres
};

/// Describes the groups of unseen cubes of a result. poses: the poses of the search. Of the
/// options, the axes, the model's box, the bodies and the chainage of the first pose are used.
/// Everything is empty for a result that was not asked for seen space. Throws InputError for poses
/// of another search and as reading the tables does.
UnseenGroups find_unseen_groups(const Result& result, const std::vector<Pose>& poses,
                                const ConflictOptions& options = {});

}  // namespace clearway
