#pragma once

#include <atomic>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "clearway/found_place.hpp"
#include "findings/row_pieces.hpp"

namespace clearway {

/// The nearest of the places that several threads offer for each of some numbers; of equally near
/// ones that with the smallest source. Most places are no nearer than what is known, and need no
/// lock.
class LeastPlaces {
 public:
  explicit LeastPlaces(std::size_t count) : places_(count), known_(count) {
    for (auto& known : known_) known = std::numeric_limits<double>::infinity();
  }

  /// Whether a place at this distance may be the nearest one.
  bool may_be_least(std::size_t number, double distance) const {
    return distance <= known_[number].load(std::memory_order_relaxed);
  }

  void offer(std::size_t number, const FoundPlace& found) {
    if (!may_be_least(number, found.distance)) return;
    locks_.hold(number, [&] {
      std::optional<FoundPlace>& least = places_[number];
      const auto key = [](const FoundPlace& of) { return std::pair(of.distance, of.source); };
      if (least && key(found) >= key(*least)) return;
      least = found;
      known_[number].store(found.distance, std::memory_order_relaxed);
    });
  }

  const std::optional<FoundPlace>& operator[](std::size_t number) const { return places_[number]; }

 private:
  std::vector<std::optional<FoundPlace>> places_;
  std::vector<std::atomic<double>> known_;
  SharedLocks locks_;
};

}  // namespace clearway
