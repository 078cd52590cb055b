#include "io/convert/distribute/distribution.hpp"

#include <algorithm>
#include <utility>

namespace clearway {
namespace {

UnitPoints room_for(std::size_t count) {
  return {std::make_unique_for_overwrite<DistributedPoint[]>(count), count};
}

}  // namespace

Distribution::Distribution(const SplitTree& tree,
                           const std::optional<std::filesystem::path>& folder, std::size_t files) {
  for (const std::uint32_t node : tree.units()) counts_.push_back(tree.nodes()[node].count);
  if (!folder) {
    for (const std::uint64_t count : counts_) memory_.push_back(room_for(count));
    return;
  }
  files = std::min(files, units());
  std::vector<std::uint64_t> bytes(files);
  for (std::size_t unit = 0; unit < units(); ++unit) {
    const std::size_t file = unit % files;
    places_.push_back({file, bytes[file]});
    bytes[file] += counts_[unit] * sizeof(DistributedPoint);
    temporary_bytes_ += counts_[unit] * sizeof(DistributedPoint);
  }
  for (const std::uint64_t size : bytes) {
    files_.push_back(File::create_temporary(*folder));
    files_.back().reserve(size);
  }
}

void Distribution::put(std::size_t unit, std::uint64_t first,
                       std::span<const DistributedPoint> points) {
  if (files_.empty()) {
    std::copy(points.begin(), points.end(), memory_[unit].points.get() + first);
    return;
  }
  const auto& [file, byte] = places_[unit];
  files_[file].write_at(byte + first * sizeof(DistributedPoint), std::as_bytes(points));
}

UnitPoints Distribution::take(std::size_t unit) {
  if (files_.empty()) return std::move(memory_[unit]);
  UnitPoints all = room_for(counts_[unit]);
  const auto& [file, byte] = places_[unit];
  files_[file].read_at(byte, std::as_writable_bytes(std::span(all.points.get(), all.count)));
  return all;
}

}  // namespace clearway
