#include "python/model.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/error.hpp"
#include "clearway/outline.hpp"
#include "python/values.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

using Triangle = std::array<std::uint32_t, 3>;
using Corners = py::array_t<std::uint32_t, py::array::c_style>;

py::array triangles_array(const std::vector<Triangle>& triangles) {
  Corners array({static_cast<py::ssize_t>(triangles.size()), py::ssize_t{3}});
  std::copy_n(triangles.empty() ? nullptr : triangles.front().data(), 3 * triangles.size(),
              array.mutable_data());
  return array;
}

/// Triangles from an array of n x 3 whole numbers, each below `points`.
std::vector<Triangle> triangles_of(const py::handle& object, std::size_t points) {
  const py::array array = py::module_::import("numpy").attr("asarray")(object);
  if (array.size() == 0) return {};
  const char kind = array.dtype().kind();
  if (kind != 'i' && kind != 'u') {
    throw py::type_error("triangles: expected whole numbers, found " +
                         std::string(py::str(array.dtype())));
  }
  if (array.ndim() != 2 || array.shape(1) != 3) {
    throw UsageError("triangles: expected an array of n x 3 indices of vertices");
  }
  const auto indices = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>(array);
  std::vector<Triangle> triangles(static_cast<std::size_t>(indices.shape(0)));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t index = indices.data()[3 * i + k];
      if (index < 0 || static_cast<std::uint64_t>(index) >= points) {
        throw UsageError("triangles: triangle " + std::to_string(i) + " has the vertex " +
                         std::to_string(index) + ", expected 0 to " +
                         std::to_string(static_cast<std::int64_t>(points) - 1));
      }
      triangles[i][k] = static_cast<std::uint32_t>(index);
    }
  }
  return triangles;
}

void add_shape(py::module_& module) {
  py::class_<Model> shapes(
      module, "Model", "A model: points, or a surface of triangles, which is searched as it is.");
  shapes.attr("NO_SOLID") = kNoSolid;
  shapes
      .def(py::init([](const py::object& vertices, const py::object& triangles, double spacing) {
             if (!(spacing >= 0) || !std::isfinite(spacing)) {
               throw UsageError("spacing: expected metres from 0");
             }
             Model model;
             model.vertices = points_of(points_array(vertices, "vertices"), "vertices");
             model.triangles = triangles_of(triangles, model.vertices.size());
             model.spacing = spacing;
             return model;
           }),
           "vertices"_a, "triangles"_a = py::tuple(), "spacing"_a = 0.0,
           R"(__init__(self, vertices, triangles=(), spacing=0.0)
--

Make a model of arrays.

vertices: n x 3 real numbers, metres, in the model's own frame.
triangles: m x 3 indices of vertices. Empty: the vertices themselves are the model.
spacing: where the vertices are samples of a mesh, how far its surface may be from them, metres.)")
      .def_property_readonly(
          "vertices", [](const Model& s) { return to_array(s.vertices); },
          "The points of the model, or the corners of its triangles: n x 3 float64, metres.")
      .def_property_readonly(
          "triangles", [](const Model& s) { return triangles_array(s.triangles); },
          "The triangles, each as three indices of vertices: n x 3 uint32. Empty where the model "
          "is "
          "its points.")
      .def_property_readonly(
          "solid_of", [](const Model& s) { return to_array(s.solid_of); },
          "The number of the solid that each triangle belongs to, or NO_SOLID: n uint32. Empty "
          "where "
          "nothing has an inside.")
      .def_readonly("spacing", &Model::spacing,
                    "Metres. The vertices are samples of a mesh, and no place of its surface is "
                    "farther than this from one of them. 0 where the model is no sampled mesh.")
      .def_property_readonly(
          "file_axes", [](const Model& s) { return to_tuple(s.file_axes); },
          "The axes of the model's file that pointed ahead and up before the model was turned, "
          "such "
          "as ('+y', '+z'); ('+x', '+z') where it was not turned.")
      .def("__repr__", [](const Model& s) {
        return text("<Model: " + std::to_string(s.vertices.size()) + " vertices, " +
                    std::to_string(s.triangles.size()) + " triangles>");
      });
}

void add_read_model_points(py::module_& module) {
  module.def(
      "read_model_points",
      [](const py::object& path, const EnvironmentUnitArgument& environment_unit,
         const py::object& messages, const py::kwargs& given) {
        const ModelOptions options = model_options(ModelAs::kPoints, given, environment_unit);
        return to_array(read_noting(messages, [&, file = path_of(path)](auto* noted) {
          auto read = read_model_points(file, options, noted);
          check_unit_is_given(file, environment_unit, options.unit, *noted);
          return read;
        }));
      },
      "path"_a, py::kw_only(), "environment_unit"_a = py::none(), "messages"_a = py::none(),
      ("read_model_points(path, *, " + signature_of(kModelFields) +
       R"DOC(, environment_unit=None, messages=None)
--

Read a model: points of a scan's format, or a mesh (STL, OBJ, PLY with faces, OFF).

The surface of a mesh is sampled to points. Returns n x 3 float64, metres, in the model's frame.
read_model() also keeps how far the surface may be from the points, so that answers say it.

path: the file.
)DOC" + lines_of(kModelFields) +
       R"DOC(environment_unit: the environment's unit, into which a known unit is converted:
    store.metres_per_unit(), store.length_unit(), or a name. None: the metre; a file that names
    another unit is refused then.
messages: a list to which notes and warnings are appended.)DOC")
          .c_str());
  add_checks(module, "read_model_points", kModelFields);
}

void add_read_model(py::module_& module) {
  module.def(
      "read_model",
      [](const py::object& path, const std::string& model_as,
         const EnvironmentUnitArgument& environment_unit, const py::object& messages,
         const py::kwargs& given) {
        const ModelOptions options = model_options(
            value_of("model_as", kChoices<ModelAs>, model_as), given, environment_unit);
        return read_noting(messages, [&, file = path_of(path)](auto* noted) {
          Model read = read_model(file, options, noted);
          check_unit_is_given(file, environment_unit, options.unit, *noted);
          return read;
        });
      },
      "path"_a, "model_as"_a = "auto", py::kw_only(), "environment_unit"_a = py::none(),
      "messages"_a = py::none(),
      ("read_model(path, model_as='auto', *, " + signature_of(kModelFields) +
       R"DOC(, environment_unit=None, messages=None)
--

Read a model, to be searched as it is. Returns a Model.

path: the file.
)DOC" + lines_of(kKindOfModel) +
       lines_of(kModelFields) +
       R"DOC(environment_unit, messages: as read_model_points() takes them.)DOC")
          .c_str());
  add_checks(module, "read_model", kKindOfModel);
  add_checks(module, "read_model", kModelFields);
}

}  // namespace

namespace {

void refuse_none(const py::handle& object) {
  if (!object.is_none()) return;
  throw UsageError(
      "model: expected a Model or an array of points, n x 3, or () where bodies are given; found "
      "None");
}

}  // namespace

py::tuple to_tuple(const ModelAxes& axes) {
  return py::make_tuple(name_of(axes.forward), name_of(axes.up));
}

py::object model_object(const py::handle& object) {
  refuse_none(object);
  if (py::isinstance<Model>(object)) return py::reinterpret_borrow<py::object>(object);
  return points_array(object, "model");
}

Model model_of(const py::object& object) {
  refuse_none(object);
  if (py::isinstance<Model>(object)) return object.cast<Model>();
  Model model;
  model.vertices = points_of(points_array(object, "model"), "model");
  return model;
}

ModelOptions model_options(ModelAs as, const py::kwargs& given,
                           const EnvironmentUnitArgument& environment_unit) {
  ModelOptions options;
  set_fields(kModelFields, given, options);
  const EnvironmentUnit environment = environment_unit_of(environment_unit);
  options.as = as;
  options.environment_unit = environment.metres;
  options.environment_unit_is_assumed = environment.is_assumed;
  return options;
}

std::string model_words(const py::object& object) {
  if (py::isinstance<Model>(object)) {
    const std::size_t triangles = object.cast<const Model&>().triangles.size();
    if (triangles > 0) return std::to_string(triangles) + " model triangles";
    return std::to_string(object.cast<const Model&>().vertices.size()) + " model points";
  }
  return std::to_string(py::len(object)) + " model points";
}

namespace {

void add_made_models(py::module_& module) {
  module.def("box_model", &box_model, "length"_a, "width"_a, "height"_a,
             R"(box_model(length, width, height)
--

Make a closed box that stands on z = 0, with its middle over the origin. Returns a Model, a solid.

length, width, height: its sides along x, y and z, metres.)");
  module.def(
      "outline_model",
      [](const py::object& outline, double rear, double front) {
        return outline_model(outline_of(outline, "outline"), rear, front);
      },
      "outline"_a, "rear"_a, "front"_a,
      R"(outline_model(outline, rear, front)
--

Make a closed solid with this cross-section, such as a load or a clearance gauge. Returns a Model.

outline: corners y, z of a simple polygon, n x 2, metres; y is to the left, z up.
rear, front: where the solid begins and ends along x, metres.)");
  module.def(
      "read_outline",
      [](const py::object& path, bool mirror, const UnitArgument& unit,
         const py::object& messages) {
        const OutlineOptions options{.mirror = mirror, .unit = file_unit(unit)};
        const auto corners = read_noting(messages, [&, file = path_of(path)](auto* noted) {
          return read_outline(file, options, noted);
        });
        py::array_t<double> array({static_cast<py::ssize_t>(corners.size()), py::ssize_t{2}});
        double* at = array.mutable_data();
        for (const auto& [y, z] : corners) {
          *at++ = y;
          *at++ = z;
        }
        return array;
      },
      "path"_a, py::kw_only(), "mirror"_a = false, "unit"_a = 0.0, "messages"_a = py::none(),
      R"(read_outline(path, *, mirror=False, unit=0.0, messages=None)
--

Read an outline from a file of text, two numbers in each line. Returns its corners y, z in metres.

path: the file, with the names y,z in its first line or none.
mirror: the file has height,half_width of one half of a symmetric outline.
unit: unit of the file: 'mm', 'cm', 'm', 'in', 'ift', 'us-ft' or its length in metres; 0: metres.
messages: a list to which a warning of half an outline is appended.)");
}

}  // namespace

void add_model(py::module_& module) {
  add_shape(module);
  add_made_models(module);
  add_read_model_points(module);
  add_read_model(module);
}

}  // namespace clearway::python
