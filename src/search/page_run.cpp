#include "search/page_run.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "core/sweep/tolerance.hpp"
#include "core/util/format.hpp"
#include "search/memory_budget.hpp"
#include "stream/paginate.hpp"
#include "stream/run_pages.hpp"
#include "stream/write_result.hpp"

namespace clearway {
namespace {

/// What a model field whose voxel is chosen may take, bytes, from the best to the least.
constexpr std::uint64_t kFieldBytes[] = {std::uint64_t{64} << 20, std::uint64_t{16} << 20,
                                         std::uint64_t{4} << 20, std::uint64_t{1} << 20};

/// With less memory pages get smaller once fewer slots than this are left.
constexpr std::uint32_t kFewSlots = 4;

/// The layouts of an engine from the best to the least.
std::vector<SlotLayout> layouts(const PageEngineKind& kind, std::uint64_t least_page_bytes) {
  std::vector<SlotLayout> out;
  for (std::uint32_t cells = kind.page_cells; cells > 0; cells /= 2) {
    const std::uint64_t wanted = kind.page_bytes / kind.page_cells * cells;
    const std::uint32_t fewest = cells > 1 ? std::min(kind.most_slots, kFewSlots) : 1;
    for (std::uint32_t slots = kind.most_slots; slots >= fewest; --slots) {
      out.push_back({slots, std::max(wanted, least_page_bytes), cells});
    }
  }
  if (out.back().page_bytes > least_page_bytes) out.push_back({1, least_page_bytes, 1});
  return out;
}

/// While the trees over model and poses are built: 48 bytes a model point, and 168 a pose. Choosing
/// what a tolerance keeps takes less.
std::uint64_t tree_building_bytes(const Query& query) {
  return 48 * query.model.size() + 168 * query.poses.size();
}

/// The query as it is searched: with a tolerance, less of model and trajectory.
class SearchedQuery {
 public:
  SearchedQuery(const Query& asked, EngineReport& report) : asked_(asked) {
    if (!(asked.tolerance > 0)) return;
    const Stopwatch clock;
    thinned_.emplace(asked);
    const std::size_t points = thinned_->query().model.size();
    const std::size_t poses = thinned_->query().poses.size();
    report.tolerance = {.model_points_kept = points,
                        .poses_kept = poses,
                        .resolved_by_bounds = 0,
                        .thin_seconds = clock.seconds()};
    spdlog::info("tolerance {} m: {} of {} model points and {} of {} poses are searched",
                 asked.tolerance, format_count(points), format_count(asked.model.size()),
                 format_count(poses), format_count(asked.poses.size()));
  }

  const Query& get() const { return thinned_ ? thinned_->query() : asked_; }
  std::uint64_t allocated_bytes() const { return thinned_ ? thinned_->allocated_bytes() : 0; }

 private:
  const Query& asked_;
  std::optional<ThinnedQuery> thinned_;
};

/// Finds a plan and a layout that fit the memory.
class Budget {
 public:
  Budget(const StoreReader& store, const Query& asked, const SearchedQuery& searched,
         const EngineOptions& options, const PageEngineKind& kind)
      : store_(store),
        asked_(asked),
        query_(searched.get()),
        options_(options),
        kind_(kind),
        trees_(query_),
        building_bytes_(tree_building_bytes(asked)),
        kept_bytes_(program_bytes(kind.threads) + input_bytes(store, asked) +
                    searched.allocated_bytes() + result_bytes(store, asked)) {}

  void find() {
    // With a tolerance the answer depends on the field, which memory must not decide.
    if (options_.field_voxel > 0 || query_.tolerance > 0) {
      if (fits_with(kFieldBytes[0], 0, true)) return;
    } else {
      const std::uint64_t least = *std::rbegin(kFieldBytes);
      for (const std::uint64_t field_bytes : kFieldBytes) {
        // The coarse lattice is a quarter more.
        const std::uint64_t while_built = field_bytes == least ? 0 : field_bytes + field_bytes / 4;
        if (fits_with(field_bytes, while_built, field_bytes == least)) return;
      }
    }
    if (smallest_bytes_) refuse_memory(*smallest_bytes_, options_.memory_bytes);
    refuse_device_memory(smallest_device_bytes_, kind_.most_device_bytes, kind_.short_device);
  }

  SearchPlan& plan() { return *plan_; }
  const SlotLayout& layout() const { return layout_; }
  double field_seconds() const { return trees_.model_seconds + field_seconds_; }
  double plan_seconds() const { return trees_.motion_seconds + plan_seconds_; }
  std::uint64_t needed_bytes() const { return needed_bytes_; }
  std::uint64_t write_bytes() const { return options_.memory_bytes - kept_bytes(layout_); }

 private:
  /// From here to the end of the run. A page under way has one record of the journal at a time.
  std::uint64_t kept_bytes(const SlotLayout& layout) const {
    const std::uint64_t pages = std::uint64_t{kind_.devices} * layout.slots;
    const auto threads = static_cast<std::uint64_t>(kind_.threads);
    return kept_bytes_ +
           SearchJournal::most_bytes(store_, asked_, static_cast<int>(std::min(pages, threads)));
  }

  /// Whether there is a plan with such a field, and a layout, or the best of them only, that fit.
  bool fits_with(std::uint64_t field_bytes, std::uint64_t while_built, bool any_layout) {
    const std::uint64_t building =
        std::max(trees_.allocated_bytes() + while_built, building_bytes_);
    if (while_built > 0 && kept_bytes_ + building > options_.memory_bytes) return false;
    plan_.reset();
    plan_.emplace(store_, query_, trees_,
                  ModelFieldOptions{.voxel = options_.field_voxel,
                                    .fineness = kind_.field_fineness,
                                    .reach = query_.clearance,
                                    .most_bytes = field_bytes},
                  options_.threads);
    field_seconds_ += plan_->field_seconds;
    plan_seconds_ += plan_->plan_seconds;
    const std::uint64_t planned =
        trees_.allocated_bytes() + plan_->allocated_bytes() + run_pages_bytes(plan_->cells.size());
    for (const SlotLayout& layout : layouts(kind_, plan_->least_page_bytes())) {
      const std::uint64_t searching = planned + kind_.host_bytes(*plan_, layout);
      const std::uint64_t kept = kept_bytes(layout);
      needed_bytes_ = kept + std::max(searching, least_write_bytes());
      layout_ = layout;
      const std::uint64_t budget = std::max(needed_bytes_, kept + building);
      const std::uint64_t on_device = kind_.device_bytes ? kind_.device_bytes(*plan_, layout) : 0;
      const bool device_fits = on_device <= kind_.most_device_bytes;
      if (device_fits && budget <= options_.memory_bytes) return true;
      if (device_fits) smallest_bytes_ = std::min(smallest_bytes_.value_or(budget), budget);
      smallest_device_bytes_ = std::min(smallest_device_bytes_, on_device);
      if (!any_layout && !kind_.device_bytes) break;  // for a device fewer slots are cheaper
    }
    return false;
  }

  const StoreReader& store_;
  const Query& asked_;
  const Query& query_;
  const EngineOptions& options_;
  const PageEngineKind& kind_;
  const QueryTrees trees_;
  const std::uint64_t building_bytes_;  ///< of the trees
  const std::uint64_t kept_bytes_;      ///< to the end of the run, but for the journal
  std::optional<SearchPlan> plan_;
  SlotLayout layout_;
  double field_seconds_ = 0, plan_seconds_ = 0;  ///< of all plans tried
  std::uint64_t needed_bytes_ = 0;
  std::optional<std::uint64_t> smallest_bytes_;  ///< of what fits the device
  std::uint64_t smallest_device_bytes_ = std::numeric_limits<std::uint64_t>::max();
};

}  // namespace

SearchResult run_page_engine(const StoreReader& store, const Query& query,
                             const EngineOptions& options, const PageEngineKind& kind,
                             const std::function<SearchJournal&()>& open, Progress& progress,
                             EngineReport& report) {
  const SearchedQuery searched(query, report);
  throw_if_stopped(progress);
  Budget budget(store, query, searched, options, kind);
  budget.find();
  SearchPlan& plan = budget.plan();
  report.plan_seconds = budget.plan_seconds();
  report.field_seconds = budget.field_seconds();
  report.field_voxel = plan.field.voxel();
  report.needed_bytes = budget.needed_bytes();
  report.write_bytes = budget.write_bytes();
  spdlog::info("model field: voxel {:.4g} m, {} bricks, {}", plan.field.voxel(),
               format_count(plan.field.bricks()), format_size(plan.field.allocated_bytes()));

  throw_if_stopped(progress);
  const Stopwatch making;
  const PageEngines engines = kind.make(plan, budget.layout());
  report.engine_seconds = making.seconds();
  SearchJournal& journal = open();
  std::erase_if(plan.cells,
                [&](const PlannedCell& cell) { return journal.cell_finished(cell.cell); });
  const std::vector<PlannedPage> pages =
      paginate(store, plan.cells, budget.layout().page_bytes, budget.layout().cells);
  report.pages = pages.size();
  report.page_bytes = budget.layout().page_bytes;
  std::vector<PageEngine*> lanes;
  for (const auto& engine : engines) {
    report.slots += engine->slots();
    lanes.push_back(engine.get());
  }
  SearchResult answer = run_pages(store, plan.cells, pages, lanes, query, kind.threads, progress,
                                  report.stages, &journal);
  kind.finished(plan, engines, report);
  return answer;
}

}  // namespace clearway
