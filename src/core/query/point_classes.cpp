#include "core/query/point_classes.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/util/format.hpp"

namespace clearway {
namespace {

constexpr std::size_t kMostNamed = 3;

}  // namespace

const char* class_name(std::uint8_t value) {
  constexpr std::array kNames{"never classified",
                              "unclassified",
                              "ground",
                              "low vegetation",
                              "medium vegetation",
                              "high vegetation",
                              "building",
                              "low noise",
                              "",
                              "water",
                              "rail",
                              "road surface",
                              "",
                              "wire, guard",
                              "wire, conductor",
                              "transmission tower",
                              "wire connector",
                              "bridge deck",
                              "high noise"};
  return value < kNames.size() ? kNames[value] : "";
}

std::string class_words(std::uint8_t value) {
  if (value <= 1) return "";
  const std::string name = class_name(value);
  const std::string number = std::to_string(value);
  return name.empty() ? "class " + number : name + " (" + number + ")";
}

void count_classes(std::span<const std::uint8_t> classes, ClassCounts& counts) {
  std::array<std::uint64_t, 256> of_each{};
  for (const std::uint8_t value : classes) ++of_each[value];
  for (std::size_t value = 0; value < of_each.size(); ++value) {
    if (of_each[value] > 0) counts[static_cast<std::uint8_t>(value)] += of_each[value];
  }
}

std::string classified_words(const ClassCounts& counts, std::uint64_t points) {
  std::vector<std::pair<std::uint8_t, std::uint64_t>> named;
  for (const auto& one : counts) {
    if (!class_words(one.first).empty()) named.push_back(one);
  }
  std::ranges::stable_sort(named, std::ranges::greater(),
                           &std::pair<std::uint8_t, std::uint64_t>::second);
  std::string text;
  std::uint64_t others = 0;
  for (std::size_t i = 0; i < named.size(); ++i) {
    const auto& [value, count] = named[i];
    if (i >= kMostNamed) {
      others += count;
    } else if (i == 0) {
      text = format_count(count) + " of " + counted(points, "point") +
             (count == 1 ? " is" : " are") + " classified as " + class_words(value);
    } else {
      text += ", " + format_count(count) + " as " + class_words(value);
    }
  }
  return others == 0 ? text : text + ", " + format_count(others) + " as others";
}

}  // namespace clearway
