#pragma once

#include <string>
#include <vector>

namespace clearway {

/// The runs of ascending numbers as texts, such as "3" and "7-9".
template <typename Number>
std::vector<std::string> number_ranges(const std::vector<Number>& numbers) {
  std::vector<std::string> ranges;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    ranges.push_back(std::to_string(numbers[i]));
    if (last > i) ranges.back() += "-" + std::to_string(numbers[last]);
    i = last + 1;
  }
  return ranges;
}

}  // namespace clearway
