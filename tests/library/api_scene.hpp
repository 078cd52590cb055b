#pragma once

#include "clearway/clearway.hpp"
#include "support/store_fixture.hpp"

namespace clearway::test {

/// A wall of 40,000 points in a store of many cells, and a model of two points that goes along it.
struct ApiScene {
  ApiScene() {
    std::vector<Quantum> wall;
    for (std::int32_t i = 0; i < 40'000; ++i) wall.push_back({20 * (i / 40), 0, 25 * (i % 40)});
    write_las(folder / "wall.las", wall, {{0.001, 0.001, 0.001}, {0, 0, 0}});
    convert({folder / "wall.las"}, folder / "wall.h5", {.cell_points = 64, .threads = 2});
    query.model = {{0, 0, 0}, {0, 0.02, 0.3}};
    for (int i = 0; i < 200; ++i) {
      query.poses.push_back({{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.1 * i, 0.04, 0.2}});
    }
    query.radius = 0.1;
  }

  ScratchFolder folder;
  Query query;
};

}  // namespace clearway::test
