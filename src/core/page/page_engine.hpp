#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/page/page.hpp"
#include "core/query/search_result.hpp"

namespace clearway {

/// A cell within reach of the trajectory, and the nodes of the motion tree that may touch it, in
/// the order of their poses.
struct PlannedCell {
  std::uint32_t cell;
  std::vector<std::uint32_t> nodes;
};

using Clock = std::chrono::steady_clock;

struct Interval {
  Clock::time_point begin, end;
};

/// What an engine found in a page, cell after cell in the page's order.
struct PageResult {
  /// Colliding points: blocks_per_cell words for each cell; bit i is point i
  std::span<const std::uint64_t> hits;
  /// First poses, blocks_per_cell * 64 for each cell; empty if not asked for
  std::span<const std::uint32_t> first_poses;
  /// Clearances, blocks_per_cell * 64 for each cell; empty if not asked for
  std::span<const Clearance> clearances;
  /// Facts of the profile, if asked for: they include those of the true profile's points in this
  /// page, and none is tied.
  std::span<const ProfileFact> profile{};
  Interval upload{}, compute{};  ///< times during which the page was sent, and searched
  /// What further questions of the same visit found, in their order
  std::span<const PageResult> further{};
};

/// The values of cell `index` of a page that has `size` values for each cell; empty if it has none.
template <typename Value>
std::span<Value> part_of_cell(std::span<Value> values, std::size_t index, std::size_t size) {
  return values.empty() ? values : values.subspan(index * size, size);
}

/// The one interface by which the pipeline knows an engine that works cell by cell. A slot holds
/// one page at a time: the pipeline fills it, calls start, then finish. Different threads may use
/// different slots at once. The pages and answers of all slots are allocated when the engine is
/// made.
class PageEngine {
 public:
  virtual ~PageEngine() = default;

  /// Number of pages that may be in flight; at least 1.
  virtual std::uint32_t slots() const = 0;

  /// Whether all pages take about equally long. If so, one thread waits for one after another;
  /// otherwise each has a thread, so that no page waits behind a slow one.
  virtual bool pages_alike() const { return true; }

  /// The memory of a slot's page, to be filled: of the same size in every slot, aligned to
  /// kPageAlignment.
  virtual std::span<std::byte> page(std::uint32_t slot) = 0;

  /// Where the engine finds the coordinates of a cell outside of the slot's page, which then need
  /// not be copied into it; nothing where it does not. Such coordinates stay there until release().
  virtual std::optional<CellPayload> kept(std::uint32_t /*slot*/, std::uint32_t /*cell*/) {
    return std::nullopt;
  }

  /// Searches the page in the slot, whose shape must fit the slot; a GPU goes on by itself after
  /// the call. If this throws, nothing of the slot is in flight.
  virtual void start(std::uint32_t slot, const PageShape& shape) = 0;

  /// Starts as start() does, with the coordinates where `first` has them: an engine on the same
  /// device, which has been started with the page of the same cells in its slot of this number, and
  /// not again before this search is finished. The page in the slot is a copy of that page up to
  /// the payloads, and may have other nodes. shape: without payloads.
  virtual void start_beside(PageEngine& first, std::uint32_t slot, const PageShape& shape) {
    move_payloads(page(slot).data(), shape.cells, page(slot).data(), first.page(slot).data());
    start(slot, shape);
  }

  /// Waits, if a GPU searches, until finish() has nothing to wait for. Throws the search's error.
  virtual void wait(std::uint32_t /*slot*/) {}

  /// Waits for the answer, which stays valid until the slot is started again. Throws the search's
  /// error; the slot is then no longer in flight.
  virtual PageResult finish(std::uint32_t slot) = 0;

  /// Lets go of the coordinates that kept() has found for the slot. Called once what was found in
  /// its page has been taken.
  virtual void release(std::uint32_t /*slot*/) {}
};

}  // namespace clearway
