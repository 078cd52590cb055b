#include "io/store/convert/bin_counter.hpp"

#include <algorithm>
#include <utility>

namespace clearway {
namespace {

std::uint64_t hash_of(const std::array<std::uint64_t, 3>& key) {
  std::uint64_t h = key[0] * 0x9E3779B97F4A7C15U;
  h = (h ^ (h >> 32) ^ key[1]) * 0xD6E8FEB86659FD93U;
  h = (h ^ (h >> 32) ^ key[2]) * 0x9E3779B97F4A7C15U;
  return h ^ (h >> 29);
}

/// Compares two keys, without the call of memcmp that std::array makes.
bool same(const std::array<std::uint64_t, 3>& a, const std::array<std::uint64_t, 3>& b) {
  return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) == 0;
}

}  // namespace

BinCounter::BinCounter(unsigned least_shift, std::size_t most_bins)
    : shift_(least_shift),
      most_bins_(most_bins),
      slots_(std::bit_ceil(2 * std::max<std::size_t>(2, most_bins))) {}

void BinCounter::clear() {
  slots_.assign(slots_.size(), {});
  occupied_ = last_ = 0;
}

BinCounter::Slot& BinCounter::find(const Key& key) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t at = hash_of(key) & mask;
  while (slots_[at].count != 0 && !same(slots_[at].key, key)) at = (at + 1) & mask;
  return slots_[at];
}

void BinCounter::add_key(const Key& key, std::uint64_t count) {
  Slot& slot = find(key);
  if (slot.count == 0) {
    slot.key = key;
    ++occupied_;
  }
  slot.count += count;
  last_ = static_cast<std::size_t>(&slot - slots_.data());
}

void BinCounter::add(const LatticePoint& point, std::uint64_t count) {
  const Key key{point[0] >> shift_, point[1] >> shift_, point[2] >> shift_};
  Slot& last = slots_[last_];
  if (last.count != 0 && same(last.key, key)) {
    last.count += count;
    return;
  }
  add_key(key, count);
  while (occupied_ > most_bins_) coarsen();
}

void BinCounter::coarsen() {
  const std::vector<Slot> old = std::exchange(slots_, std::vector<Slot>(slots_.size()));
  occupied_ = 0;
  ++shift_;
  for (const Slot& slot : old) {
    if (slot.count != 0) {
      add_key({slot.key[0] >> 1, slot.key[1] >> 1, slot.key[2] >> 1}, slot.count);
    }
  }
}

void BinCounter::merge(const BinCounter& other) {
  while (shift_ < other.shift_) coarsen();
  for (const Slot& slot : other.slots_) {
    if (slot.count == 0) continue;
    LatticePoint corner{};
    for (std::size_t k = 0; k < 3; ++k) corner[k] = slot.key[k] << other.shift_;
    add(corner, slot.count);
  }
}

std::vector<Bin> BinCounter::bins() const {
  std::vector<Bin> bins;
  for (const Slot& slot : slots_) {
    if (slot.count == 0) continue;
    Bin bin{{}, {}, slot.count};
    for (std::size_t k = 0; k < 3; ++k) {
      bin.lo[k] = slot.key[k] << shift_;
      bin.hi[k] = bin.lo[k] + (std::uint64_t{1} << shift_);
    }
    bin.lo[3] = 0;
    bin.hi[3] = kAllSources;
    bins.push_back(bin);
  }
  std::sort(bins.begin(), bins.end(), [](const Bin& a, const Bin& b) { return a.lo < b.lo; });
  return bins;
}

}  // namespace clearway
