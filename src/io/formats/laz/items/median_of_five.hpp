#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace clearway::laz {

/// A running median, by which LAZ predicts differences. It holds five values in order, and each new
/// value replaces the least or the greatest. Which of the two is replaced changes when a new value
/// is not on the side where the last one was dropped.
class MedianOfFive {
 public:
  std::int32_t median() const { return values_[2]; }

  void add(std::int32_t value) {
    const std::int32_t* kept = values_.data() + (drop_greatest_ ? 0 : 1);
    drop_greatest_ = drop_greatest_ ? value < values_[2] : value <= values_[2];
    const std::array<std::int32_t, 4> old{kept[0], kept[1], kept[2], kept[3]};
    values_[0] = std::min(old[0], value);
    for (unsigned i = 1; i < 4; ++i) values_[i] = std::max(old[i - 1], std::min(old[i], value));
    values_[4] = std::max(old[3], value);
  }

 private:
  std::array<std::int32_t, 5> values_{};
  bool drop_greatest_ = true;
};

}  // namespace clearway::laz
