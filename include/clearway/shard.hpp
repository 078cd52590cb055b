#pragma once

#include <cstdint>
#include <string>

namespace clearway {

/// One of the parts that a query's work is divided into, each for a run of its own; merge() makes
/// one result of all parts.
struct Shard {
  static constexpr std::uint32_t kMost = 1000;  ///< greatest number of parts of a query

  std::uint32_t number = 1;  ///< from 1 to count
  std::uint32_t count = 1;

  bool is_valid() const { return number >= 1 && number <= count && count <= kMost; }
  friend bool operator==(const Shard&, const Shard&) = default;
};

/// The shard in short, such as "2/7".
inline std::string to_string(const Shard& shard) {
  return std::to_string(shard.number) + "/" + std::to_string(shard.count);
}

/// The shard in words, such as "part 2 of 7".
inline std::string in_words(const Shard& shard) {
  return "part " + std::to_string(shard.number) + " of " + std::to_string(shard.count);
}

}  // namespace clearway
