#include "python/arrays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "core/geometry/rigid.hpp"

namespace clearway::python {
namespace {

std::string shape_of(const py::array& array) {
  std::string shape;
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    shape += (i == 0 ? "" : " x ") + std::to_string(array.shape(i));
  }
  return array.ndim() == 0 ? "a single value" : shape;
}

[[noreturn]] void refuse_shape(const char* name, const char* expected, const py::array& found) {
  throw UsageError(std::string(name) + ": expected an array of " + expected + ", found " +
                   shape_of(found));
}

void refuse_masked(const py::handle& object, const char* name) {
  const py::module_ masked = py::module_::import("numpy.ma");
  if (!py::isinstance(object, masked.attr("MaskedArray"))) return;
  if (!masked.attr("is_masked")(object).cast<bool>()) return;
  throw UsageError(std::string(name) + ": some values are masked: leave them out before");
}

/// The array that numpy.asarray() makes of an object without masked values.
py::array array_of(const py::handle& object, const char* name) {
  refuse_masked(object, name);
  try {
    return py::module_::import("numpy").attr("asarray")(object);
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
    throw UsageError(std::string(name) +
                     ": is no array of numbers: " + std::string(py::str(error.value())));
  }
}

bool is_empty_list(const py::array& array) { return array.size() == 0 && array.ndim() == 1; }

/// The array of an object that holds real numbers. Throws TypeError for anything else.
py::array numbers(const py::handle& object, const char* name) {
  py::array array = array_of(object, name);
  const char kind = array.dtype().kind();
  if (kind == 'f' || kind == 'i' || kind == 'u' || is_empty_list(array)) return array;
  throw py::type_error(std::string(name) + ": expected real numbers, found " +
                       std::string(py::str(array.dtype())));
}

Doubles empty(std::vector<py::ssize_t> shape) { return Doubles(std::move(shape)); }

void require_finite(std::span<const double> numbers, std::size_t of_one, const char* name,
                    const char* one) {
  const auto bad = std::ranges::find_if(numbers, [](double x) { return !std::isfinite(x); });
  if (bad == numbers.end()) return;
  throw InputError(
      std::string(name) + ": " + one + " " + std::to_string((bad - numbers.begin()) / of_one) +
      ": expected finite numbers, found " + (std::isnan(*bad) ? "nan" : "infinity") +
      (std::string_view(one) == "pose" ? "; leave such poses out, because a body has no place there"
                                       : ""));
}

std::span<const double> all_of(const Doubles& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

}  // namespace

Doubles points_array(const py::handle& object, const char* name) {
  const py::array array = numbers(object, name);
  if (array.ndim() == 1 && array.size() == 0) return empty({0, 3});
  if (array.ndim() != 2 || array.shape(1) != 3) refuse_shape(name, "n x 3 numbers", array);
  return Doubles(array);
}

Doubles poses_array(const py::handle& object, const char* name) {
  const py::array array = numbers(object, name);
  if (array.ndim() == 1 && array.size() == 0) return empty({0, 4, 4});
  const bool fits =
      array.ndim() == 3 && array.shape(2) == 4 && (array.shape(1) == 3 || array.shape(1) == 4);
  if (!fits) refuse_shape(name, "n x 4 x 4 or n x 3 x 4 numbers", array);
  Doubles doubles(array);
  // Numbers are checked first, because a pose of NaN alone would otherwise be refused for its last
  // row.
  require_finite(all_of(doubles), static_cast<std::size_t>(4 * doubles.shape(1)), name, "pose");
  if (doubles.shape(1) == 3) return doubles;
  const double* pose = doubles.data();
  for (py::ssize_t i = 0; i < doubles.shape(0); ++i, pose += 16) {
    if (pose[12] == 0 && pose[13] == 0 && pose[14] == 0 && pose[15] == 1) continue;
    throw UsageError(std::string(name) + ": pose " + std::to_string(i) +
                     ": expected 0 0 0 1 in the last row; the translation is the last column");
  }
  return doubles;
}

std::vector<Vec3> points_of(const Doubles& array, const char* name) {
  const std::span<const double> numbers = all_of(array);
  require_finite(numbers, 3, name, "point");
  std::vector<Vec3> points(numbers.size() / 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
  }
  return points;
}

std::vector<OutlinePoint> outline_of(const py::handle& object, const char* name) {
  const py::array array = numbers(object, name);
  if (array.ndim() == 1 && array.size() == 0) return {};
  if (array.ndim() != 2 || array.shape(1) != 2) refuse_shape(name, "n x 2 numbers", array);
  const Doubles doubles(array);
  require_finite(all_of(doubles), 2, name, "corner");
  std::vector<OutlinePoint> corners(static_cast<std::size_t>(doubles.shape(0)));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = {doubles.data()[2 * i], doubles.data()[2 * i + 1]};
  }
  return corners;
}

std::vector<Pose> poses_of(const Doubles& array, const char* name) {
  const std::span<const double> numbers = all_of(array);
  const auto of_one = static_cast<std::size_t>(4 * array.shape(1));
  require_finite(numbers, of_one, name, "pose");
  std::vector<Pose> poses(numbers.size() / of_one);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double* from = numbers.data() + i * of_one;
    for (int row = 0; row < 3; ++row) {
      std::copy_n(from + 4 * row, 3, poses[i].rotation + 3 * row);
      poses[i].translation[row] = from[4 * row + 3];
    }
  }
  return poses;
}

std::vector<Pose> poses_of(const py::kwargs& given, const char* name) {
  return poses_of(poses_array(given[name], name), name);
}

void require_rigid(const std::vector<Pose>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Stretch stretch = stretch_of(poses[i]);
    if (is_rigid(stretch)) continue;
    throw InputError("pose " + std::to_string(i) +
                         ": the matrix is not a rotation: it stretches by " +
                         std::to_string(stretch.least) + " to " + std::to_string(stretch.greatest) +
                         (stretch.determinant > 0 ? "" : " and mirrors"),
                     Remedy::kAllowNonRigid);
  }
}

py::array_t<double> to_array(const std::vector<Pose>& poses) {
  std::vector<double> numbers(16 * poses.size(), 0.0);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    double* to = numbers.data() + 16 * i;
    for (int row = 0; row < 3; ++row) {
      std::copy_n(poses[i].rotation + 3 * row, 3, to + 4 * row);
      to[4 * row + 3] = poses[i].translation[row];
    }
    to[15] = 1;
  }
  return to_array(std::move(numbers))
      .reshape(std::vector<py::ssize_t>{static_cast<py::ssize_t>(poses.size()), 4, 4})
      .cast<py::array_t<double>>();
}

py::array_t<double> to_array(const Vec3& point) {
  py::array_t<double> array(3);
  for (int axis = 0; axis < 3; ++axis) array.mutable_at(axis) = point[axis];
  return array;
}

Vec3 point_of(const py::handle& object, const char* name) {
  const py::array array = numbers(object, name);
  if (array.ndim() != 1 || array.size() != 3) refuse_shape(name, "3 numbers", array);
  const Doubles numbers(array);
  require_finite(all_of(numbers), 3, name, "point");
  return {numbers.at(0), numbers.at(1), numbers.at(2)};
}

std::vector<std::uint32_t> indices_of(const py::handle& object, const char* name) {
  const py::array array = array_of(object, name);
  if (is_empty_list(array)) return {};
  const char kind = array.dtype().kind();
  if (kind != 'i' && kind != 'u') {
    throw py::type_error(std::string(name) + ": expected whole numbers, found " +
                         std::string(py::str(array.dtype())));
  }
  if (array.ndim() != 1) refuse_shape(name, "n whole numbers", array);
  const auto wide = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>(array);
  std::vector<std::uint32_t> indices;
  for (py::ssize_t i = 0; i < wide.size(); ++i) {
    const std::int64_t index = wide.at(i);
    if (index < 0 || index > std::numeric_limits<std::uint32_t>::max()) {
      throw UsageError(std::string(name) + "[" + std::to_string(i) +
                       "]: expected 0 to 4294967295, found " + std::to_string(index));
    }
    indices.push_back(static_cast<std::uint32_t>(index));
  }
  return indices;
}

}  // namespace clearway::python
