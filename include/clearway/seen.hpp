#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace clearway {

/// What is known of the space that the model sweeps: how many cubes it sweeps, and how many of them
/// no beam passed through. An unseen cube may hold anything.
struct SeenSummary {
  double cube = 0;           ///< side of a cube along x, metres: a multiple of the store's step
  std::uint64_t swept = 0;   ///< number of cubes that the model sweeps
  std::uint64_t seen = 0;    ///< how many of them a beam passed through
  std::uint64_t unseen = 0;  ///< swept - seen
  std::uint64_t groups = 0;  ///< groups of unseen cubes that touch each other
  /// Groups of at least QueryParameters::seen_min cubes, which make a verdict undecided
  std::uint64_t listed_groups = 0;
  std::uint64_t listed_cubes = 0;  ///< number of cubes in these groups
  /// Length of the path, in metres, on which the model first reaches cubes of listed groups: from
  /// each pose that does to the next one. Gaps shorter than a cube count too, because with poses
  /// closer than a cube not every pose reaches a new one.
  double not_scanned_length = 0;

  friend bool operator==(const SeenSummary&, const SeenSummary&) = default;
};

/// Cubes that the model sweeps and no beam passed through, one row per cube, ascending by cube.
struct UnseenCubes {
  /// Indices along x, y and z: cube i holds the stored integers from side * i to side * (i + 1)
  /// - 1.
  std::vector<std::array<std::int32_t, 3>> cube;
  std::vector<std::uint32_t> first_pose;  ///< the first pose at which the model sweeps each cube
  /// Number of each cube's group, from 1 on: groups are ordered by their least first pose, and then
  /// by their least cube. 0 in a shard's part, whose groups are made when it is merged.
  std::vector<std::uint32_t> group;
  /// Chainage of each cube's first pose, and the length of the path from it to the next pose,
  /// metres. Only in a shard's part, whose merge needs them.
  std::vector<double> chainage = {}, step = {};

  std::size_t size() const { return cube.size(); }
};

}  // namespace clearway
