#pragma once

#include <cstdint>
#include <list>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page.hpp"
#include "gpu/device_arrays.hpp"

namespace clearway {

/// Packed coordinates of a cloud's cells that stay on a CUDA device, so that pages need not bring
/// them again. The least recently used cells leave where there is no room for others. Thread safe.
class ResidentCells {
 public:
  /// Takes at most `bytes` on the current device. The cloud outlives it. Throws ResourceError.
  ResidentCells(const PackedCloud& cloud, std::uint64_t bytes);

  /// A place for a cell on the device, held until release().
  struct Place {
    std::uint32_t cell = 0;
    std::uint32_t index = 0;
    std::byte* begin = nullptr;  ///< where the cell's bytes are, or are to be copied to
    bool filled = false;
    CellPayload payload{};  ///< as seen from address 0, where it is filled
  };

  /// The place of a cell that is there.
  std::optional<Place> find(std::uint32_t cell);
  /// An empty place for a cell, from which another cell may have left; nothing where all places are
  /// held, or where the cell is there, is coming, or may not be kept.
  std::optional<Place> room_for(std::uint32_t cell);
  /// Gives a place back. A place that the caller has filled keeps its cell from now on; an empty
  /// one is free.
  void release(const Place& place);

 private:
  struct Held {
    std::uint32_t cell = 0;
    std::uint32_t holders = 0;
    bool filled = false;
    CellPayload payload{};
    std::list<std::uint32_t>::iterator order{};
  };

  const PackedCloud& cloud_;
  const std::uint64_t place_bytes_;
  DeviceBuffer memory_;
  std::mutex mutex_;
  std::vector<Held> places_;
  std::list<std::uint32_t> order_;  ///< indices of places, the most recently used ones first
  std::unordered_map<std::uint32_t, std::uint32_t> place_of_;  ///< by cell
};

}  // namespace clearway
