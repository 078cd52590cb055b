#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "support/store_fixture.hpp"

/// Stores whose points have origins.
namespace clearway::test {

using OriginQuanta = std::array<std::int64_t, 3>;

/// The origins of a store's points, by source index; nullopt for points without one.
inline std::vector<std::optional<OriginQuanta>> origins_by_source(const StoreReader& store) {
  std::vector<std::optional<OriginQuanta>> origins(store.metadata().input_points);
  for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
    const auto numbers = store.origins(cell);
    const auto sources = store.sources(cell);
    for (std::uint32_t i = 0; i < store.cells()[cell].count; ++i) {
      if (numbers[i] > 0) origins[sources[i]] = store.metadata().origins->quanta[numbers[i] - 1];
    }
  }
  return origins;
}

}  // namespace clearway::test
