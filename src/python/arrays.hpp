#pragma once

#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/outline.hpp"
#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "python/python.hpp"

/// Conversion of NumPy arrays from and to values of the library. Arrays that are handed out are
/// made of the library's vectors without a copy.
namespace clearway::python {

/// An array of float64, row by row. It is converted from an array of any other real numbers,
/// including long double.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Points as an n x 3 array of float64 in metres, row by row: the same array where it has that form
/// already, otherwise a copy. Takes whatever numpy.asarray() takes. Throws TypeError for anything
/// but real numbers, and UsageError for another shape and for masked points.
Doubles points_array(const py::handle& object, const char* name);

/// Poses as an n x 3 x 4 or n x 4 x 4 array of float64, row by row: the same array where it has
/// that form already, otherwise a copy. Throws TypeError for anything but real numbers, UsageError
/// for another shape, for masked poses and for 4 x 4 matrices whose last row is not 0 0 0 1, and
/// InputError for numbers that are not finite.
Doubles poses_array(const py::handle& object, const char* name);

/// Copies of an array's points or poses. Throw InputError for numbers that are not finite.
std::vector<Vec3> points_of(const Doubles& array, const char* name);
std::vector<Pose> poses_of(const Doubles& array, const char* name);

/// A copy of the argument `poses`, or of the one of this name.
std::vector<Pose> poses_of(const py::kwargs& given, const char* name = "poses");

/// The corners of an outline from an array of n x 2 numbers. Throws as points_array().
std::vector<OutlinePoint> outline_of(const py::handle& object, const char* name);

/// Throws InputError for a pose that scales, shears or mirrors.
void require_rigid(const std::vector<Pose>& poses);

/// The poses as an array of shape n x 4 x 4.
py::array_t<double> to_array(const std::vector<Pose>& poses);
/// The point as an array of shape 3.
py::array_t<double> to_array(const Vec3& point);

/// A point from three finite numbers.
Vec3 point_of(const py::handle& object, const char* name);

/// An array of n whole numbers from 0 to 2^32 - 1. Throws TypeError for other numbers, and
/// UsageError for another shape or a number out of range.
std::vector<std::uint32_t> indices_of(const py::handle& object, const char* name);

/// A Python object that owns the vector.
template <typename Value>
py::capsule keep(std::vector<Value> values) {
  using Values = std::vector<Value>;
  auto kept = std::make_unique<Values>(std::move(values));
  py::capsule owner(kept.get(), [](void* held) { delete static_cast<Values*>(held); });
  (void)kept.release();
  return owner;
}

/// An array over the vector's memory, which `owner` keeps: of n numbers, or of n x 3 where an
/// element of the vector has three of them.
template <typename Value>
auto array_over(const std::vector<Value>& values, const py::handle& owner) {
  const auto rows = static_cast<py::ssize_t>(values.size());
  if constexpr (std::is_arithmetic_v<Value>) {
    return py::array_t<Value>(rows, values.data(), owner);
  } else {
    using Number = std::remove_cvref_t<decltype(std::declval<Value&>()[0])>;
    static_assert(sizeof(Value) == 3 * sizeof(Number));
    const auto* const first = reinterpret_cast<const Number*>(values.data());
    return py::array_t<Number>(std::vector<py::ssize_t>{rows, 3}, first, owner);
  }
}

/// An array over the vector's memory, which it owns; its shape is that of array_over().
template <typename Value>
auto to_array(std::vector<Value> values) {
  const py::capsule owner = keep(std::move(values));
  return array_over(*owner.get_pointer<std::vector<Value>>(), owner);
}

}  // namespace clearway::python
