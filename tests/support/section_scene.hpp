#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "clearway/section.hpp"
#include "core/section/section_ref.hpp"
#include "core/trajectory/chainage.hpp"
#include "support/memory_cloud.hpp"
#include "support/scenes.hpp"

/// Random scenes for sections, and what is blocked in them by every pair of a point and a pose, by
/// the definitions of docs/design/section.md alone.
namespace clearway {

/// (bin, k, j) to the first pose.
using Blocked = std::map<std::tuple<std::uint64_t, std::int64_t, std::int64_t>, std::uint32_t>;

struct SectionScene {
  std::vector<Quantum> quanta;
  Quantisation quantisation{{0.001, 0.001, 0.001}, {0, 0, 0}};
  std::uint32_t cell_points = 1024;
  std::vector<Pose> path;
  std::vector<std::uint32_t> path_pose;  ///< poses of the path that the load has
  std::vector<Box> ignored;
  SectionParameters asked;

  std::vector<Pose> load() const {
    std::vector<Pose> poses;
    for (const std::uint32_t i : path_pose) poses.push_back(path[i]);
    return poses;
  }
};

/// x with R x + p = e, by Cramer's rule in the order of operations that is documented.
inline std::array<double, 3> place_of(const Pose& pose, const Vec3& e) {
  const double* r = pose.rotation;
  const double d[3] = {e.x - pose.translation[0], e.y - pose.translation[1],
                       e.z - pose.translation[2]};
  const double cofactor[3][3] = {
      {r[4] * r[8] - r[5] * r[7], r[2] * r[7] - r[1] * r[8], r[1] * r[5] - r[2] * r[4]},
      {r[5] * r[6] - r[3] * r[8], r[0] * r[8] - r[2] * r[6], r[2] * r[3] - r[0] * r[5]},
      {r[3] * r[7] - r[4] * r[6], r[1] * r[6] - r[0] * r[7], r[0] * r[4] - r[1] * r[3]}};
  const double determinant = cofactor[0][0] * r[0] + cofactor[0][1] * r[3] + cofactor[0][2] * r[6];
  std::array<double, 3> x{};
  for (std::size_t k = 0; k < 3; ++k) {
    x[k] = (cofactor[k][0] * d[0] + cofactor[k][1] * d[1] + cofactor[k][2] * d[2]) / determinant;
  }
  return x;
}

inline Blocked by_brute_force(const SectionScene& scene, double along) {
  const SectionParameters& asked = scene.asked;
  const double from = asked.rear - asked.margin - along / 2;
  const double to = asked.front + asked.margin + along / 2;
  const double g = asked.cell;
  std::vector<double> chainage{0};
  for (std::size_t i = 1; i < scene.path.size(); ++i) {
    const double *a = scene.path[i - 1].translation, *b = scene.path[i].translation;
    const double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    chainage.push_back(chainage.back() + std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
  }
  Blocked blocked;
  for (const Vec3& e : positions_of(scene.quanta, scene.quantisation)) {
    const bool is_ignored =
        std::any_of(scene.ignored.begin(), scene.ignored.end(), [&e](const Box& box) {
          return box.lo.x <= e.x && e.x <= box.hi.x && box.lo.y <= e.y && e.y <= box.hi.y &&
                 box.lo.z <= e.z && e.z <= box.hi.z;
        });
    if (is_ignored) continue;
    for (const std::uint32_t pose : scene.path_pose) {
      const auto [x, y, z] = place_of(scene.path[pose], e);
      if (!(from <= x && x <= to)) continue;
      const double j = std::floor(y / g), k = std::floor(z / g);
      const SectionWindow& w = *asked.window;
      if (!(std::floor(w.y_from / g) <= j && j < std::ceil(w.y_to / g) &&
            std::floor(w.z_from / g) <= k && k < std::ceil(w.z_to / g))) {
        continue;
      }
      const auto bin = static_cast<std::uint64_t>(std::floor(chainage[pose] / asked.bin));
      const auto at = std::tuple(bin, static_cast<std::int64_t>(k), static_cast<std::int64_t>(j));
      const auto cell = blocked.try_emplace(at, pose).first;
      cell->second = std::min(cell->second, pose);
    }
  }
  return blocked;
}

inline void shift(SectionScene& scene, const Vec3& by) {
  for (int k = 0; k < 3; ++k) scene.quantisation.offset[k] += by[k];
  for (Pose& pose : scene.path) {
    for (int k = 0; k < 3; ++k) pose.translation[k] += by[k];
  }
  for (Box& box : scene.ignored) box = {box.lo + by, box.hi + by};
}

/// Poses that stand on a lattice, with axes along those of the scan: places lie on borders.
inline std::vector<Pose> square_path(Random& random, std::size_t count) {
  const double angles[4] = {0, 1, 0, -1};
  std::vector<Pose> poses;
  Vec3 at{0, 0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    Pose pose = translation(at);
    const double c = angles[(i / 8 + 1) % 4], s = angles[(i / 8) % 4];
    const double rotation[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
    std::copy(rotation, rotation + 9, pose.rotation);
    poses.push_back(pose);
    at = at + Vec3{0.25 * c, 0.25 * s, below(random, 8) == 0 ? 0.25 : 0.0};
  }
  return poses;
}

/// Lets the range and the window end where poses see a point, to the last bit.
inline void end_at_a_point(Random& random, SectionScene& scene) {
  const std::vector<Vec3> points = positions_of(scene.quanta, scene.quantisation);
  const auto place = [&] {
    const std::uint32_t pose = scene.path_pose[below(random, scene.path_pose.size())];
    return place_of(scene.path[pose], points[below(random, points.size())]);
  };
  SectionParameters& asked = scene.asked;
  asked.margin = 0;
  const double ends[] = {place()[0], place()[0]};
  asked.rear = std::min(ends[0], ends[1]);
  asked.front = std::max(ends[0], ends[1]);
  SectionWindow& w = *asked.window;
  const auto [x, y, z] = place();
  if (y < w.y_to) w.y_from = std::max(y, w.y_to - 8);
  if (z > w.z_from) w.z_to = std::min(z, w.z_from + 8);
}

inline SectionScene random_section_scene(Random& random) {
  SectionScene scene;
  const Box box{{-6, -5, -2}, {6, 5, 3}};
  const std::size_t poses = 1 + below(random, 60);
  const bool lattice = below(random, 3) == 0;
  if (lattice) {
    scene.quantisation.scale[0] = scene.quantisation.scale[1] = scene.quantisation.scale[2] =
        below(random, 2) == 0 ? 0.125 : 0.1;
    scene.path = square_path(random, poses);
  } else {
    scene.path = smooth_path(random, box, poses);
    if (below(random, 4) == 0) {
      for (Pose& pose : scene.path) pose = random_rotation(random, pose.position());
    }
    if (below(random, 2) == 0) {
      for (Pose& pose : scene.path) pose = printed_with_six_digits(pose);
    }
    // Backwards, or forwards and then back.
    if (below(random, 4) == 0) std::reverse(scene.path.begin(), scene.path.end());
    if (below(random, 8) == 0) {
      for (std::size_t i = poses / 2; i < poses; ++i) scene.path[i] = scene.path[poses - 1 - i];
    }
  }
  if (below(random, 4) == 0 && poses > 3) scene.path[poses / 2] = scene.path[poses / 2 - 1];
  const std::size_t points = below(random, 12) == 0 ? below(random, 3) : below(random, 1500);
  scene.quanta = quantise(random_points(random, box, points), scene.quantisation);
  if (below(random, 4) == 0 && !scene.quanta.empty()) {
    for (int i = 0; i < 20; ++i) scene.quanta.push_back(scene.quanta[0]);
  }
  const std::uint32_t sizes[] = {64, 192, 1024};
  scene.cell_points = sizes[below(random, 3)];
  for (std::uint32_t i = 0; i < poses; ++i) {
    if (below(random, 10) > 0 || poses == 1) scene.path_pose.push_back(i);
  }
  if (scene.path_pose.empty()) scene.path_pose.push_back(0);
  SectionParameters& asked = scene.asked;
  asked.rear = lattice ? -0.25 * static_cast<double>(below(random, 9)) : uniform(random, -3, 1);
  asked.front = asked.rear + (below(random, 6) == 0 ? 0 : lattice ? 1.5 : uniform(random, 0, 4));
  asked.window = lattice ? SectionWindow{-1.5, 2, -0.5, 1.25}
                         : SectionWindow{uniform(random, -4, 0), uniform(random, 0.01, 4),
                                         uniform(random, -2, 0), uniform(random, 0.01, 3)};
  asked.cell = lattice ? (below(random, 2) == 0 ? 0.25 : 0.1) : uniform(random, 0.02, 0.6);
  asked.bin = below(random, 4) == 0 ? 1e6 : uniform(random, 0.3, 6);
  asked.margin = below(random, 2) == 0 ? 0 : 0.25;
  if (below(random, 4) == 0) scene.ignored.push_back({{-2, -2, -2}, {2, 3, 1}});
  const Vec3 utm{521234.25, 5412345.5, 312.75};
  if (below(random, 3) == 0) shift(scene, utm);
  if (below(random, 4) == 0 && !scene.quanta.empty()) end_at_a_point(random, scene);
  return scene;
}

/// A search for the section of a scene, before it begins.
struct SectionOfScene {
  SectionOfScene(const SectionScene& scene, double along)
      : poses(scene.load()),
        path_pose(scene.path_pose),
        cloud(scene.quanta, scene.quantisation, {.cell_points = scene.cell_points}),
        lattice(section_lattice(scene.asked, along)),
        bins(section_bins(chainage_of(scene.path), path_pose, scene.asked)),
        tree(poses, path_pose, bins),
        maps(lattice, bins.size()),
        section(section_ref(
            tree, lattice, section_rounding(largest_coordinate(cloud), poses, scene.asked, lattice),
            maps)) {
    query.ignore_boxes = scene.ignored;
  }
  SectionOfScene(const SectionOfScene&) = delete;

  /// What is blocked in the maps now.
  Blocked blocked() const {
    Blocked out;
    for (std::size_t bin = 0; bin < bins.size(); ++bin) {
      const std::span firsts = maps.firsts(bin);
      for (std::uint32_t row = 0; row < lattice.rows; ++row) {
        for (std::uint32_t column = 0; column < lattice.columns; ++column) {
          const std::uint32_t pose = firsts[std::uint64_t{row} * lattice.columns + column];
          if (pose == kNotBlocked) continue;
          out[{bins[bin].number, static_cast<std::int64_t>(lattice.k_from) + row,
               static_cast<std::int64_t>(lattice.j_from) + column}] = pose;
        }
      }
    }
    return out;
  }

  std::vector<Pose> poses;
  std::vector<std::uint32_t> path_pose;
  MemoryCloud cloud;
  SectionLattice lattice;
  std::vector<SectionBin> bins;
  SectionPoses tree;
  SectionMaps maps;
  SectionRef section;
  QueryParameters query;  ///< says which points are ignored
};

}  // namespace clearway
