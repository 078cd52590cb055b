#pragma once

#include <optional>
#include <string>

#include "clearway/model.hpp"
#include "core/describe/model.hpp"
#include "python/arrays.hpp"
#include "python/python.hpp"
#include "python/values.hpp"

/// Models of queries and reports: an array of points, or a Model.
namespace clearway::python {

/// The names of two axes, ahead and up, as Python shows them: ("+y", "+z").
py::tuple to_tuple(const ModelAxes& axes);

/// A Model is returned as it is, and anything else as points_array() converts it.
py::object model_object(const py::handle& object);

/// A copy of a model. object: one that model_object() returned. Throws InputError for numbers that
/// are not finite.
Model model_of(const py::object& object);

/// The options for the arguments that are described fields. Throws UsageError for an unknown unit
/// and for unknown axes.
ModelOptions model_options(ModelAs as, const py::kwargs& given,
                           const EnvironmentUnitArgument& environment_unit);

/// The size of a model in words, such as "12 model points" or "12 model triangles".
std::string model_words(const py::object& object);

}  // namespace clearway::python
