#include "gpu/resident_cells.hpp"

#include <algorithm>

namespace clearway {
namespace {

/// Bytes of a place, in which every cell fits with what may be read past it.
std::uint64_t bytes_of_place(const PackedCloud& cloud) {
  std::uint64_t most = 0;
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) {
    most = std::max(most, cloud.packed_bytes(cell));
  }
  return ArrayRun::aligned(most + kPagePadding);
}

}  // namespace

ResidentCells::ResidentCells(const PackedCloud& cloud, std::uint64_t bytes)
    : cloud_(cloud),
      place_bytes_(bytes_of_place(cloud)),
      memory_(place_bytes_ * std::min<std::uint64_t>(bytes / place_bytes_, cloud.cells().size())),
      places_(memory_.bytes() / place_bytes_) {
  // Words past a cell's end are read, though they decide nothing.
  if (memory_.bytes() > 0) check_cuda(cudaMemset(memory_.data(), 0, memory_.bytes()));
  for (std::uint32_t index = 0; index < places_.size(); ++index) {
    places_[index].order = order_.insert(order_.end(), index);
  }
}

std::optional<ResidentCells::Place> ResidentCells::find(std::uint32_t cell) {
  const std::lock_guard lock(mutex_);
  const auto at = place_of_.find(cell);
  if (at == place_of_.end()) return std::nullopt;
  const std::uint32_t index = at->second;
  Held& held = places_[index];
  if (!held.filled) return std::nullopt;  // another question is bringing it
  ++held.holders;
  order_.splice(order_.begin(), order_, held.order);
  return Place{cell, index, memory_.data() + index * place_bytes_, true, held.payload};
}

std::optional<ResidentCells::Place> ResidentCells::room_for(std::uint32_t cell) {
  // What is read in place on the host can be kept, because the host may need it too.
  if (!cloud_.in_place(cell)) return std::nullopt;
  const std::lock_guard lock(mutex_);
  if (place_of_.contains(cell)) return std::nullopt;
  const auto is_free = [&](std::uint32_t index) { return places_[index].holders == 0; };
  const auto last = std::find_if(order_.rbegin(), order_.rend(), is_free);
  if (last == order_.rend()) return std::nullopt;
  const std::uint32_t index = *last;
  Held& held = places_[index];
  place_of_.emplace(cell, index);
  const auto before = place_of_.find(held.cell);
  if (before != place_of_.end() && before->second == index && held.cell != cell) {
    place_of_.erase(before);
  }
  held = {cell, 1, false, {}, held.order};
  order_.splice(order_.begin(), order_, held.order);
  return Place{cell, index, memory_.data() + index * place_bytes_, false, {}};
}

void ResidentCells::release(const Place& place) {
  const std::lock_guard lock(mutex_);
  Held& held = places_[place.index];
  --held.holders;
  if (held.filled) return;
  if (place.filled) {
    held.filled = true;
    held.payload = place.payload;
    return;
  }
  place_of_.erase(place.cell);
  order_.splice(order_.end(), order_, held.order);
}

}  // namespace clearway
