#include "core/seen/cross_sections.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace clearway {
namespace {

constexpr std::int64_t kFarthest = 1'000'000;  // sides from the pose
constexpr unsigned kCellBits = 24;             // of a cell's index, moved above 0
constexpr std::int64_t kMiddleCell = std::int64_t{1} << (kCellBits - 1);

std::uint64_t key_of(unsigned axis, std::int64_t a, std::int64_t b) {
  return (std::uint64_t{axis} << kCellBits | static_cast<std::uint64_t>(a + kMiddleCell))
             << kCellBits |
         static_cast<std::uint64_t>(b + kMiddleCell);
}

std::array<std::int32_t, 3> cell_of(std::uint64_t key) {
  constexpr std::uint64_t kMask = (std::uint64_t{1} << kCellBits) - 1;
  const auto index = [&](std::uint64_t bits) {
    return static_cast<std::int32_t>(static_cast<std::int64_t>(bits & kMask) - kMiddleCell);
  };
  return {static_cast<std::int32_t>(key >> 2 * kCellBits), index(key >> kCellBits), index(key)};
}

}  // namespace

void CrossSections::add(const Vec3& middle) {
  // Along each axis a cube lies in the cell of its lower end and in the next one.
  std::int64_t cell[3];
  std::uint64_t in_next[3];
  for (int k = 0; k < 3; ++k) {
    const double steps = middle[k] / side_ * static_cast<double>(kSteps);
    if (!(std::abs(steps) < static_cast<double>(kFarthest * kSteps))) return;
    const std::int64_t lower = static_cast<std::int64_t>(std::floor(steps + 0.5)) - kSteps / 2;
    cell[k] = lower >> 6;
    in_next[k] = static_cast<std::uint64_t>(lower & (kSteps - 1));
  }
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
    for (unsigned next = 0; next < 4; ++next) {
      const unsigned next_a = next & 1, next_b = next >> 1;
      const std::uint64_t along_a = next_a == 1 ? in_next[a] : kSteps - in_next[a];
      const std::uint64_t along_b = next_b == 1 ? in_next[b] : kSteps - in_next[b];
      if (along_a * along_b == 0) continue;
      add(key_of(axis, cell[a] + next_a, cell[b] + next_b), along_a * along_b);
    }
  }
}

void CrossSections::add(const CrossSections& other) {
  for (const Place& place : other.places_) {
    if (place.parts > 0) add(place.key, place.parts);
  }
}

void CrossSections::add(std::uint64_t key, std::uint64_t parts) {
  if (2 * (used_ + 1) > places_.size()) grow();
  const std::size_t mask = places_.size() - 1;
  std::size_t at = (key * 0x9E3779B97F4A7C15U) >> 32 & mask;
  while (places_[at].parts != 0 && places_[at].key != key) at = (at + 1) & mask;
  used_ += places_[at].parts == 0 ? 1 : 0;
  places_[at].key = key;
  places_[at].parts += parts;
}

void CrossSections::grow() {
  std::vector<Place> before(std::max<std::size_t>(1024, 2 * places_.size()));
  std::swap(before, places_);
  used_ = 0;
  for (const Place& place : before) {
    if (place.parts > 0) add(place.key, place.parts);
  }
}

SweptCells CrossSections::cells() const {
  std::vector<Place> found;
  found.reserve(used_);
  for (const Place& place : places_) {
    if (place.parts > 0) found.push_back(place);
  }
  std::ranges::sort(found, {}, &Place::key);
  SweptCells out;
  for (const Place& place : found) {
    out.cell.push_back(cell_of(place.key));
    out.parts.push_back(place.parts);
  }
  return out;
}

}  // namespace clearway
