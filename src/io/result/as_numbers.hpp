#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "clearway/vec3.hpp"

namespace clearway {

static_assert(sizeof(Vec3) == 3 * sizeof(double));

/// The coordinates x, y, z of all points as one sequence, as the file stores them.
inline std::span<double> as_numbers(std::span<Vec3> points) {
  return {points.empty() ? nullptr : &points.front().x, 3 * points.size()};
}

inline std::span<const double> as_numbers(std::span<const Vec3> points) {
  return {points.empty() ? nullptr : &points.front().x, 3 * points.size()};
}

/// How a value of a column is stored: as one number, or as a row of several.
template <typename Value>
struct StoredValue {
  using Number = Value;
  static constexpr std::size_t kNumbers = 0;  ///< 0: the dataset has no second dimension
};
template <>
struct StoredValue<Vec3> {
  using Number = double;
  static constexpr std::size_t kNumbers = 3;
};
template <>
struct StoredValue<std::array<std::int32_t, 3>> {
  using Number = std::int32_t;
  static constexpr std::size_t kNumbers = 3;
};

/// The numbers of all values of a column as one sequence, as the file stores them.
template <typename Value>
auto numbers_of(std::span<Value> values) {
  if constexpr (std::is_same_v<std::remove_const_t<Value>, Vec3>) {
    return as_numbers(values);
  } else if constexpr (std::is_same_v<Value, std::array<std::int32_t, 3>>) {
    return std::span(values.empty() ? nullptr : values.front().data(), 3 * values.size());
  } else {
    return values;
  }
}

}  // namespace clearway
