#pragma once

#include "io/store/store_reader.hpp"
#include "io/store/verify_store.hpp"
#include "staged_values.hpp"

namespace clearway::test {

/// Opens a store and reads everything in it, as `verify`, `run` and the search of cells do.
inline void read_store(const std::filesystem::path& path) {
  const StoreReader store(path);
  NoProgress progress;
  verify_store(store, progress);
  store.fingerprint();
  for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
    may_refuse([&] {
      const auto chunks = store.coordinates(cell);
      std::array<std::vector<std::int32_t>, 3> values;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        values[axis].resize(store.cell_points());
        chunks[axis].decode(0, values[axis]);
      }
      check_staged_cell(store, cell, values);
    });
  }
}

}  // namespace clearway::test
