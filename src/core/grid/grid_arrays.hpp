#pragma once

#include "core/grid/grid_scene.hpp"
#include "core/util/array_run.hpp"

/// The arrays behind a GridPageView, described once for the host and the device.
namespace clearway {

/// The arrays that plan_page() writes for a page.
struct GridPlanArrays {
  GridPlanArrays(ArrayRun& run, std::uint64_t cell_count, std::uint64_t node_count)
      : cells(run.add<GridCell>(cell_count)),
        cell_runs(run.add<std::uint64_t>(cell_count + 1)),
        entry_runs(run.add<std::uint32_t>(node_count)) {}

  void put_into(GridPageView& view, const std::byte* begin) const {
    view.cells = cells.in(begin).data();
    view.cell_runs = cell_runs.in(begin).data();
    view.entry_runs = entry_runs.in(begin).data();
  }

  ArrayPlace<GridCell> cells;
  ArrayPlace<std::uint64_t> cell_runs;
  ArrayPlace<std::uint32_t> entry_runs;
};

/// The arrays in which the cells of a page are sorted and searched.
struct GridWorkArrays {
  GridWorkArrays(ArrayRun& run, const GridScene& scene, std::uint64_t cells)
      : points(run.add<GridPoint>(cells * scene.view().slots)),
        buckets(run.add<BucketRange>(cells * scene.view().bucket_count)),
        occupancy(run.add<std::uint64_t>(cells * scene.view().word_count)),
        group_occupancy(run.add<std::uint64_t>(cells * scene.view().word_count)),
        done(run.add<std::uint64_t>(cells * scene.view().slots / 64)),
        keys(run.add<std::uint32_t>(cells * scene.view().slots)),
        order(run.add<std::uint32_t>(cells * scene.view().slots)) {}

  void put_into(GridPageView& view, std::byte* begin) const {
    view.points = points.in(begin).data();
    view.buckets = buckets.in(begin).data();
    view.occupancy = occupancy.in(begin).data();
    view.group_occupancy = group_occupancy.in(begin).data();
    view.done = done.in(begin).data();
  }

  ArrayPlace<GridPoint> points;
  ArrayPlace<BucketRange> buckets;
  ArrayPlace<std::uint64_t> occupancy, group_occupancy;
  ArrayPlace<std::uint64_t> done;
  ArrayPlace<std::uint32_t> keys, order;  ///< keys of the slots, and the slots themselves
};

}  // namespace clearway
