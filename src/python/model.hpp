#pragma once

#include <string>

#include "clearway/model.hpp"
#include "python/arrays.hpp"
#include "python/python.hpp"

/// Models of queries and reports: an array of points, or a ModelShape.
namespace clearway::python {

/// A ModelShape as it is, anything else as points_array() has it.
py::object model_object(const py::handle& object);

/// A copy. object: as model_object() has it. Throws InputError for numbers that are not finite.
ModelShape model_of(const py::object& object);

/// "12 model points", "12 model triangles".
std::string model_words(const py::object& object);

}  // namespace clearway::python
