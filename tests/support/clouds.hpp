#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "support/store_fixture.hpp"

/// Clouds of stored integers that a conversion may find hard.
namespace clearway::test {

inline std::int32_t between(std::mt19937_64& random, std::int64_t least, std::int64_t greatest) {
  return static_cast<std::int32_t>(
      std::uniform_int_distribution<std::int64_t>(least, greatest)(random));
}

inline std::vector<Quantum> cube_cloud(std::size_t count, std::int64_t least, std::int64_t greatest,
                                       std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Quantum> points(count);
  for (Quantum& p : points) {
    for (auto& q : p) q = between(random, least, greatest);
  }
  return points;
}

struct NamedCloud {
  std::string name;
  std::vector<Quantum> points;
};

/// Clouds of `count` points each: spread, with many ties, on a line, on a plane, all in one place,
/// over the whole range of the integers, and in clusters of very different density.
inline std::vector<NamedCloud> hard_clouds(std::size_t count, std::uint64_t seed) {
  std::vector<NamedCloud> clouds{
      {"spread", cube_cloud(count, -100000, 100000, seed)},
      {"ties", cube_cloud(count, -3, 3, seed + 1)},
      {"line", cube_cloud(count, -100000, 100000, seed + 2)},
      {"plane", cube_cloud(count, -1000, 1000, seed + 3)},
      {"one place", std::vector<Quantum>(count, Quantum{7, -7, 0})},
      {"whole range", cube_cloud(count, -2147483648LL, 2147483647LL, seed + 4)},
      {"clusters", cube_cloud(count, -1000000, 1000000, seed + 5)}};
  for (Quantum& p : clouds[2].points) p = {p[0], 5, -5};
  for (Quantum& p : clouds[3].points) p[1] = 42;
  std::mt19937_64 random(seed + 6);
  for (Quantum& p : clouds[6].points) {
    const int reach = 1 << (random() % 20);
    for (auto& q : p) q = q % reach + static_cast<std::int32_t>(reach) * 3;
  }
  return clouds;
}

}  // namespace clearway::test
