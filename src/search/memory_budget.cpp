#include "search/memory_budget.hpp"

#include <algorithm>

#include "clearway/error.hpp"
#include "core/query/search_result.hpp"
#include "core/util/format.hpp"
#include "cpu/cell_search.hpp"
#include "search/find_depths.hpp"
#include "stream/plan.hpp"
#include "stream/run_pages.hpp"
#include "stream/search_journal.hpp"
#include "stream/write_result.hpp"

namespace clearway {
namespace {

/// Where memory is short, pages get smaller once the number of slots is down to this.
constexpr std::uint32_t kFewSlots = 4;

}  // namespace

std::vector<SlotLayout> layouts(const PageEngineNeeds& needs, std::uint64_t least_page_bytes) {
  std::vector<SlotLayout> out;
  for (std::uint32_t cells = needs.page_cells; cells > 0; cells /= 2) {
    const std::uint64_t wanted = needs.page_bytes / needs.page_cells * cells;
    const std::uint32_t fewest = cells > 1 ? std::min(needs.most_slots, kFewSlots) : 1;
    for (std::uint32_t slots = needs.most_slots; slots >= fewest; --slots) {
      out.push_back({slots, std::max(wanted, least_page_bytes), cells});
    }
  }
  if (out.back().page_bytes > least_page_bytes) out.push_back({1, least_page_bytes, 1});
  return out;
}

SlotLayout needed_layout(const PackedCloud& cloud, std::span<const PlannedCell> cells, bool masked,
                         std::uint32_t devices, const SlotLayout& layout) {
  const auto pages = paginate(cloud, cells, layout.page_bytes, layout.cells, masked);
  SlotLayout needed{.slots = 1, .page_bytes = 0, .cells = 1};
  for (const PlannedPage& page : pages) {
    needed.page_bytes = std::max(needed.page_bytes, page.shape.bytes());
    needed.cells = std::max(needed.cells, page.shape.cells);
    needed.header_bytes = std::max(needed.header_bytes, page.shape.without_payloads().bytes());
  }
  const std::uint64_t of_a_device = divide_up(pages.size(), devices);
  needed.slots = static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(of_a_device, needed.slots, layout.slots));
  return needed;
}

std::uint64_t PageEngineKind::most_poses(const MotionTree& motion,
                                         std::span<const PlannedCell> cells) const {
  std::uint64_t most = 0;
  for (const PlannedCell& cell : cells) most = std::max(most, pose_count(motion, cell.nodes));
  return most;
}

PageBudget::PageBudget(const PackedCloud& cloud, const Query& query, std::uint64_t memory_bytes,
                       PageEngineKind& kind, const ShardCells* only,
                       std::optional<std::uint64_t> write_bytes, IgnoredPoints::Search search)
    : cloud_(cloud),
      query_(query),
      memory_bytes_(memory_bytes),
      kind_(kind),
      only_(only),
      least_write_bytes_(write_bytes),
      ignored_(cloud, query, search),
      masked_(query.ignores_points() || kind.needs().masked),
      trees_(kind.trees_of(kind.whose_trees(query))),
      building_bytes_(tree_building_bytes(query)),
      kept_bytes_(program_bytes(kind.needs().threads) + input_bytes(cloud, query) +
                  (write_bytes ? search_result_bytes(cloud, query) : 0)) {}

void PageBudget::find() {
  std::vector<PageEngineKind::IndexSize> sizes = kind_.index_sizes();
  if (kind_.needs().may_be_divided) sizes.resize(std::min<std::size_t>(sizes.size(), 2));
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (fits_with(sizes[i], i + 1 == sizes.size())) return;
  }
  if (smallest_bytes_ || kind_.needs().may_be_divided) {
    refuse_memory(smallest_bytes_.value_or(memory_bytes_), memory_bytes_);
  }
  refuse_device_memory(smallest_device_bytes_, kind_.needs().most_device_bytes,
                       kind_.needs().short_device);
}

/// Bytes that are kept from here to the end of the run. Each page in flight has at most one record
/// of the journal at a time.
std::uint64_t PageBudget::kept_bytes(const SlotLayout& layout) const {
  if (!least_write_bytes_) return kept_bytes_;
  const std::uint64_t pages = std::uint64_t{kind_.needs().devices} * layout.slots;
  const auto threads = static_cast<std::uint64_t>(kind_.needs().threads);
  return kept_bytes_ +
         SearchJournal::most_bytes(cloud_, query_, static_cast<int>(std::min(pages, threads)));
}

/// Bytes that the search starts with: trees, index and plan.
std::uint64_t PageBudget::planned_bytes() const {
  constexpr std::uint64_t kHeapBlock = 16;
  // While cells are sorted, half of them are in memory twice.
  std::uint64_t bytes = trees_.allocated_bytes() + kind_.index_bytes() +
                        3 * cells_.capacity() * sizeof(PlannedCell) / 2 +
                        run_pages_bytes(cells_.size());
  for (const PlannedCell& cell : cells_) {
    bytes += cell.nodes.capacity() * sizeof(std::uint32_t) + kHeapBlock;
  }
  return bytes;
}

/// Builds an index of this size and a plan, and returns whether a layout fits the memory with them.
/// any_layout: all layouts are tried, not only the best, as on a GPU.
bool PageBudget::fits_with(const PageEngineKind::IndexSize& size, bool any_layout) {
  const std::uint64_t building =
      std::max(trees_.allocated_bytes() + size.while_built, building_bytes_);
  if (size.while_built > 0 && kept_bytes_ + building > memory_bytes_) return false;
  cells_.clear();
  const Stopwatch clock;
  const PoseReach& reach = kind_.build_index(trees_, size.bytes);
  const double indexed = clock.seconds();
  cells_ = kind_.plan_cells(cloud_, reach);
  std::erase_if(cells_, [&](const PlannedCell& cell) {
    return (only_ != nullptr && !only_->contains(cell.cell)) || ignored_.skips(cell.cell);
  });
  index_seconds_ += indexed;
  plan_seconds_ += clock.seconds() - indexed;
  kind_.resolve_devices();
  const std::uint64_t planned = planned_bytes();
  const std::uint64_t most_poses = kind_.most_poses(trees_.motion, cells_);
  for (const SlotLayout& layout :
       layouts(kind_.needs(), smallest_page_bytes(cloud_, cells_, masked_))) {
    if (fits(layout, planned, building, most_poses)) {
      fits(needed_layout(cloud_, cells_, masked_, kind_.needs().devices, layout), planned, building,
           most_poses);
      return true;
    }
    if (kind_.needs().may_be_divided) break;
    if (!any_layout && !kind_.needs().on_gpu) break;  // a GPU gets fewer slots first
  }
  return false;
}

bool PageBudget::fits(const SlotLayout& layout, std::uint64_t planned, std::uint64_t building,
                      std::uint64_t most_poses) {
  const std::uint64_t searching = planned + kind_.host_bytes(layout, most_poses);
  const std::uint64_t kept = kept_bytes(layout);
  layout_ = layout;
  needed_bytes_ = kept + std::max(searching, least_write_bytes_.value_or(0));
  const std::uint64_t budget = std::max(needed_bytes_, kept + building);
  const std::uint64_t on_device = kind_.device_bytes(layout);
  const bool device_fits = on_device <= kind_.needs().most_device_bytes;
  if (device_fits && budget <= memory_bytes_) return true;
  if (device_fits) smallest_bytes_ = std::min(smallest_bytes_.value_or(budget), budget);
  smallest_device_bytes_ = std::min(smallest_device_bytes_, on_device);
  return false;
}

std::uint64_t program_bytes(int threads) {
  constexpr std::uint64_t kProgram = std::uint64_t{8} << 20;
  constexpr std::uint64_t kThread = std::uint64_t{256} << 10;
  return kProgram + kThread * static_cast<std::uint64_t>(threads);
}

namespace {

std::uint64_t bytes_of(const Model& model) {
  return model.vertices.size() * sizeof(model.vertices[0]) +
         model.triangles.size() * sizeof(model.triangles[0]) +
         model.solid_of.size() * sizeof(model.solid_of[0]);
}

}  // namespace

std::uint64_t input_bytes(const PackedCloud& cloud, const Query& query) {
  std::uint64_t bytes =
      cloud.allocated_bytes() + bytes_of(query.model) + query.poses.size() * sizeof(Pose);
  for (const Body& body : query.bodies) {
    // The search has a copy of model and poses.
    bytes +=
        2 * bytes_of(body.model) + body.poses.size() * (2 * sizeof(Pose) + sizeof(std::uint32_t));
  }
  return bytes;
}

std::uint64_t search_result_bytes(const PackedCloud& cloud, const Query& query) {
  std::uint64_t bytes = AnswerRows::bytes(cloud, query) + depth_bytes(cloud, query);
  if (query.profile > 0) bytes += query.poses.size() * (sizeof(ProfilePoint) + sizeof(double));
  // Further searches have a copy of model and poses.
  const bool further =
      query.first_pose || query.has_budget() || query.ignores_points() || has_floor(query);
  return bytes + (further ? input_bytes(cloud, query) - cloud.allocated_bytes() : 0);
}

std::uint64_t depth_bytes(const PackedCloud& cloud, const Query& query) {
  return query.depth ? depth_search_bytes(cloud, query) + kDeepWriteBytes : 0;
}

std::uint64_t tree_building_bytes(const Query& query) {
  const auto of_model = [](const Model& model) {
    // For solids each triangle is there once more.
    const std::uint64_t of_solids = 400 * model.solid_of.size();
    return of_solids +
           (model.is_surface() ? 240 * model.triangles.size() : 52 * model.vertices.size());
  };
  std::uint64_t bytes = 0;
  for (const MovingBody& body : moving_bodies(query)) {
    bytes += of_model(body.model) + 168 * body.poses.size();
  }
  return bytes;
}

void check_memory(std::uint64_t needed, std::uint64_t allowed) {
  if (needed > allowed) refuse_memory(needed, allowed);
}

void refuse_memory(std::uint64_t needed, std::uint64_t allowed) {
  throw ResourceError(format_size(allowed) + " of memory is too little: this search needs " +
                          format_size(needed) + " beside the mapped store",
                      Remedy::kMoreMemory, static_cast<double>(needed));
}

void refuse_device_memory(std::uint64_t needed, std::uint64_t allowed,
                          const std::string& short_device) {
  const std::string need = "this search needs " + format_size(needed);
  if (!short_device.empty()) {
    throw ResourceError(short_device + " has too little: " + need + ", and may take " +
                            format_size(allowed) + " there",
                        Remedy::kOtherGpu);
  }
  throw ResourceError(
      format_size(allowed) + " of device memory is too little: " + need + " on each device",
      Remedy::kMoreDeviceMemory, static_cast<double>(needed));
}

}  // namespace clearway
