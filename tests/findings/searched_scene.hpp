#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "clearway/clearway.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/query/search_result.hpp"
#include "support/engines/brute_force.hpp"
#include "support/scenes.hpp"
#include "support/solid_scene.hpp"
#include "support/store_fixture.hpp"

namespace clearway::test {

inline Quantum millimetres(const Vec3& p) {
  Quantum out{};
  for (int k = 0; k < 3; ++k) out[k] = static_cast<std::int32_t>(std::lround(p[k] * 1000));
  return out;
}

/// Whether any of the points collides, by trying all.
inline bool collide(const std::vector<Vec3>& points, const Query& query) {
  return std::ranges::any_of(brute_force_first_poses(points, query),
                             [](std::uint32_t first) { return first != kNoPose; });
}

/// Points in steps of a millimetre, a query, and the result of its search with first poses.
struct SearchedScene {
  static constexpr Quantisation kSteps{{0.001, 0.001, 0.001}, {0, 0, 0}};

  SearchedScene(const std::vector<Vec3>& places, Query asked) : query(std::move(asked)) {
    std::vector<Quantum> quanta;
    for (const Vec3& p : places) {
      const Quantum& q = quanta.emplace_back(millimetres(p));
      points.push_back(position(kSteps, q[0], q[1], q[2]));
    }
    write_las(folder / "scan.las", quanta, kSteps);
    convert({folder / "scan.las"}, folder / "scan.h5", {.cell_points = 64, .threads = 2});
    query.first_pose = true;
    search(Store(folder / "scan.h5"), query, folder / "out.h5",
           {.device = Device::kCpu, .threads = 2});
  }

  Result result() const { return Result(folder / "out.h5"); }

  Conflicts conflicts(ConflictOptions options = {.min_points = 1},
                      std::vector<std::uint32_t>* conflict_of = nullptr) const {
    if (query.bodies.empty()) options.model = &query.model;
    options.bodies = query.bodies;
    options.threads = 2;
    return find_conflicts(result(), query.poses, options, conflict_of);
  }

  /// The conflict of a scene that has one.
  Conflict only_conflict(const ConflictOptions& options = {.min_points = 1}) const {
    const Conflicts found = conflicts(options);
    if (found.listed.size() != 1) throw std::logic_error("not one conflict");
    return found.listed.front();
  }

  Query query;
  std::vector<Vec3> points;
  ScratchFolder folder;
};

/// A closed box as the model.
inline Query solid_box(const Box& box, std::vector<Pose> poses, double radius) {
  Bodies bodies;
  bodies.add(box_surface(box));
  return bodies.query(std::move(poses), radius);
}

/// A path along x, of at least one pose.
inline std::vector<Pose> straight_path(double length, double step = 0.5) {
  std::vector<Pose> poses;
  for (int i = 0; i * step <= length; ++i) poses.push_back(translation({i * step, 0, 0}));
  return poses;
}

}  // namespace clearway::test
