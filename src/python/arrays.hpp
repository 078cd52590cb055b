#pragma once

#include <pybind11/numpy.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "python/python.hpp"

/// NumPy arrays in and out. Out: made of the library's vectors without a copy.
namespace clearway::python {

/// float64 in rows. Made of an array of any other real numbers, long double among them.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// n x 3, metres, as float64 in rows: the same array where it is so, otherwise a copy. Takes
/// whatever numpy.asarray() takes. Throws TypeError for what holds no real numbers, UsageError for
/// another shape and for masked points.
Doubles points_array(const py::handle& object, const char* name);

/// n x 3 x 4 or n x 4 x 4, likewise; the last row of the latter has to be 0 0 0 1.
Doubles poses_array(const py::handle& object, const char* name);

/// Copies. Throw InputError for numbers that are not finite.
std::vector<Vec3> points_of(const Doubles& array, const char* name);
std::vector<Pose> poses_of(const Doubles& array, const char* name);

/// Throws InputError for a pose that scales, shears or mirrors.
void require_rigid(const std::vector<Pose>& poses);

/// n x 4 x 4.
py::array to_array(const std::vector<Pose>& poses);
py::array to_array(const Vec3& point);  ///< 3

/// Three finite numbers.
Vec3 point_of(const py::handle& object, const char* name);

/// n whole numbers from 0 to 2^32 - 1. Throws TypeError for other numbers, UsageError for another
/// shape or a number out of range.
std::vector<std::uint32_t> indices_of(const py::handle& object, const char* name);

/// Python owns the vector.
template <typename Value>
py::capsule keep(std::vector<Value> values) {
  using Values = std::vector<Value>;
  auto kept = std::make_unique<Values>(std::move(values));
  py::capsule owner(kept.get(), [](void* held) { delete static_cast<Values*>(held); });
  (void)kept.release();
  return owner;
}

/// An array that owns the vector.
template <typename Number>
py::array to_array(std::vector<Number> values) {
  const py::capsule owner = keep(std::move(values));
  const auto& kept = *owner.get_pointer<std::vector<Number>>();
  return py::array_t<Number>(static_cast<py::ssize_t>(kept.size()), kept.data(), owner);
}

/// n x 3, likewise.
py::array to_array(std::vector<Vec3> points);

}  // namespace clearway::python
