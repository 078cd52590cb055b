#pragma once

#include <optional>

#include "clearway/query.hpp"
#include "io/store/store_reader.hpp"
#include "support/scenes.hpp"
#include "support/store_fixture.hpp"

namespace clearway::test {

/// A store of points 10 mm apart along the x axis, and a query about a model that goes along it in
/// steps of 0.1 m.
struct LineOfPoints {
  LineOfPoints(int points, Model model, int poses, std::uint32_t cell_points = 64)
      : query(std::move(model), {}, {.radius = 0.1}) {
    std::vector<Quantum> line;
    for (std::int32_t i = 0; i < points; ++i) line.push_back({10 * i, 0, 0});
    write_las(folder / "line.las", line, {{0.001, 0.001, 0.001}, {0, 0, 0}});
    convert_quietly(conversion_of({folder / "line.las"}, folder / "line.h5", cell_points));
    store.emplace(folder / "line.h5");
    for (int i = 0; i < poses; ++i) query.poses.push_back(translation({0.1 * i, 0, 0}));
  }

  ScratchFolder folder;
  std::optional<StoreReader> store;
  Query query;
};

}  // namespace clearway::test
