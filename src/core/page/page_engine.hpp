#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/page/page.hpp"
#include "core/query/clearance_set.hpp"
#include "core/query/profile_set.hpp"

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

/// What an engine found in the cells of a page, in their order.
struct PageResult {
  std::span<const std::uint64_t> hits;         ///< blocks_per_cell words a cell, bit i is point i
  std::span<const std::uint32_t> first_poses;  ///< where asked for, blocks_per_cell * 64 a cell
  std::span<const Clearance> clearances;       ///< likewise
  /// Where asked for: with the true profile's points that are in the page, none of them tied.
  std::span<const ProfileFact> profile{};
  Interval upload{}, compute{};  ///< when the page was sent, and searched
};

/// Of values that a page has `size` of a cell, those of its cell `index`; none where it has none.
template <typename Value>
std::span<Value> part_of_cell(std::span<Value> values, std::size_t index, std::size_t size) {
  return values.empty() ? values : values.subspan(index * size, size);
}

/// The one interface by which the pipeline knows an engine that works cell by cell. A slot holds
/// one page at a time: filled by the pipeline, then start, then finish. Different slots may be used
/// by different threads at once. The pages and answers of all slots are allocated when the engine
/// is made.
class PageEngine {
 public:
  virtual ~PageEngine() = default;

  /// How many pages may be in flight; at least 1.
  virtual std::uint32_t slots() const = 0;

  /// Whether pages take about as long as each other: then one thread waits for one after the other,
  /// else one for each, so that no page waits behind a slow one.
  virtual bool pages_alike() const { return true; }

  /// The memory of a slot's page, to be filled: as many bytes in every slot, on kPageAlignment.
  virtual std::span<std::byte> page(std::uint32_t slot) = 0;

  /// Searches the page in the slot, whose shape fits it; a GPU goes on by itself after the call.
  /// Where it throws, nothing of the slot is in flight.
  virtual void start(std::uint32_t slot, const PageShape& shape) = 0;

  /// Waits, where a GPU searches, until finish() has nothing to wait for. Throws what became of the
  /// search.
  virtual void wait(std::uint32_t /*slot*/) {}

  /// The answer, waited for, which stays valid until the slot is started again. Throws what became
  /// of the search; the slot is then no longer in flight.
  virtual PageResult finish(std::uint32_t slot) = 0;
};

}  // namespace clearway
