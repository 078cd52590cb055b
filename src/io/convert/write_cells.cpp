#include "io/convert/write_cells.hpp"

#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "core/util/tsan_annotations.hpp"
#include "io/convert/pack_unit.hpp"

namespace clearway {
namespace {

/// A unit before it is written: its first cells are packed already, the others are packed when they
/// are written.
struct UnitInFlight {
  std::vector<PackedCell> packed;
  std::optional<OrderedUnit> rest;
};

void write_unit(UnitInFlight& unit, StoreWriter& writer, StageClocks& clocks, Progress& progress) {
  while (!unit.packed.empty()) {
    for (const PackedCell& cell : unit.packed) {
      throw_if_stopped(progress);
      const auto running = clocks.measure(Stage::kWrite);
      writer.append(cell);
      progress.advance(cell.cell.count);
    }
    unit.packed.clear();
    if (unit.rest) unit.packed = unit.rest->pack_next();
  }
}

}  // namespace

void write_cells(Distribution& distribution, const SplitTree& tree, const Lattice& lattice,
                 const StoreMetadata& metadata, std::size_t units_in_flight, StoreWriter& writer,
                 StageClocks& clocks, Progress& progress) {
  std::size_t largest = 0;
  for (std::size_t unit = 0; unit < distribution.units(); ++unit) {
    largest = std::max<std::size_t>(largest, distribution.points(unit));
  }
  UnitBuffers buffers(largest);
  using Flying = std::shared_ptr<UnitInFlight>;
  std::size_t next = 0;
  const ParallelScope scope;
  const SerialStage input, output;
  const auto number_of_next = piece_of(scope, input, [&](tbb::flow_control& flow) {
    throw_if_stopped(progress);
    if (next == tree.units().size()) flow.stop();
    return next++;
  });
  const auto order_and_pack = piece_of(scope, [&](std::size_t unit) {
    auto flying = std::make_shared<UnitInFlight>();
    flying->rest.emplace(distribution, unit, tree, lattice, metadata, buffers, clocks);
    flying->packed = flying->rest->pack_next();
    if (flying->rest->cells_left() == 0) flying->rest.reset();
    return flying;
  });
  const auto write = piece_of(
      scope, output, [&](const Flying& unit) { write_unit(*unit, writer, clocks, progress); });
  progress.begin("partition", metadata.point_count, "points");
  scope.begin();
  tbb::parallel_pipeline(
      units_in_flight,
      tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, number_of_next) &
          tbb::make_filter<std::size_t, Handed<Flying>>(tbb::filter_mode::parallel,
                                                        order_and_pack) &
          tbb::make_filter<Handed<Flying>, void>(tbb::filter_mode::serial_in_order, write));
  progress.end();
}

}  // namespace clearway
