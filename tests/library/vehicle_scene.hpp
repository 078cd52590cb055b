#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "clearway/clearway.hpp"
#include "core/geometry/quantisation.hpp"
#include "search/devices.hpp"
#include "support/catch.hpp"
#include "support/result_fixture.hpp"
#include "support/scenes.hpp"
#include "support/store_fixture.hpp"

namespace clearway::test {

/// Random points in a box, and three bodies on a path through it. The second body lacks the first
/// and the last poses, the third has some here and there; points and models of two bodies coincide
/// at some poses, so that bodies tie.
struct Vehicle {
  explicit Vehicle(std::uint64_t seed, bool gaps = true, std::size_t poses = 40) {
    Random random(seed);
    for (int i = 0; i < 2500; ++i) {
      points.push_back({static_cast<std::int32_t>(below(random, 4000)),
                        static_cast<std::int32_t>(below(random, 3000)),
                        static_cast<std::int32_t>(below(random, 1000))});
    }
    write_las(folder / "scan.las", points);
    convert({folder / "scan.las"}, folder / "scan.h5", {.cell_points = 64, .threads = 2});
    for (const Quantum& q : points) {
      places.push_back(position(kMillimetres, q[0], q[1], q[2]));
    }
    const Box room{{100, -200, 0}, {104, -197, 1}};
    query.poses = smooth_path(random, room, poses);
    const Box part{{-0.3, -0.2, -0.1}, {0.3, 0.2, 0.1}};
    for (const char* name : {"front", "middle", "rear"}) {
      Body body{
          .name = name, .model = random_points(random, part, 25), .poses = {}, .path_pose = {}};
      query.bodies.push_back(body);
    }
    query.bodies[2].model = query.bodies[0].model;
    const auto count = static_cast<std::uint32_t>(poses);
    for (std::uint32_t i = 0; i < count; ++i) {
      add(0, i, query.poses[i]);
      if (i >= 5 && i + 7 < count) {
        Pose moved = query.poses[i];
        moved.translation[0] += 0.4;
        add(1, i, moved);
      }
      Pose other = query.poses[i];
      if (i % 3 != 0) other.translation[1] -= 0.3;
      if (gaps ? i % 5 != 2 : i < 30) add(2, i, other);
    }
    query.radius = 0.06;
  }

  void add(std::size_t body, std::uint32_t pose, const Pose& at) {
    query.bodies[body].poses.push_back(at);
    query.bodies[body].path_pose.push_back(pose);
  }
  /// Makes a body's model a surface, of one triangle for every three of its points.
  void make_surface(std::size_t body) {
    const auto corners = static_cast<std::uint32_t>(query.bodies[body].model.vertices.size());
    for (std::uint32_t i = 0; i + 2 < corners; i += 3) {
      query.bodies[body].model.triangles.push_back({i, i + 1, i + 2});
    }
  }
  Query of(std::size_t body) const {
    Query own(query.bodies[body].model, query.bodies[body].poses, query);
    own.model.triangles = query.bodies[body].model.triangles;
    own.model.solid_of = query.bodies[body].model.solid_of;
    if (query.bodies[body].floor) own.floor = query.bodies[body].floor;
    return own;
  }
  /// The points for brute force, with the ignored points moved far away.
  std::vector<Vec3> searched_places() const {
    std::vector<Vec3> out = places;
    for (Vec3& place : out) {
      for (const Box& box : query.ignore_boxes) {
        bool inside = true;
        for (int k = 0; k < 3; ++k) {
          inside = inside && place[k] >= box.lo[k] && place[k] <= box.hi[k];
        }
        if (inside) place = {1e7, 1e7, 1e7};
      }
    }
    return out;
  }

  /// Runs the search on the CPU. Where there is a GPU, and memory is not limited, checks that it
  /// gives the same bytes there.
  Result run(const SearchOptions& options = {}) {
    SearchOptions how = options;
    how.threads = std::max(how.threads, 1);
    how.overwrite = true;
    const Store store(folder / "scan.h5");
    report = search(store, query, folder / "out.h5", how);
    if (how.memory_bytes == SearchOptions().memory_bytes && may_take_gpus({})) {
      how.device = Device::kCuda;
      search(store, query, folder / "gpu.h5", how);
      CHECK(bytes_of(folder / "gpu.h5") == bytes_of(folder / "out.h5"));
    }
    return Result(folder / "out.h5");
  }

  ScratchFolder folder;
  std::vector<Quantum> points;
  std::vector<Vec3> places;
  Query query;
  SearchReport report;
};

}  // namespace clearway::test
