#include "clearway/model.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/outline.hpp"
#include "core/describe/model.hpp"
#include "python/arrays.hpp"
#include "python/binding.hpp"
#include "python/objects.hpp"
#include "python/values.hpp"

namespace clearway::python {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

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

Model make_model(const py::kwargs& given) {
  Model model;
  model.spacing = argument<double>(given, "spacing");
  model.vertices = points_of(points_array(given["vertices"], "vertices"), "vertices");
  model.triangles = triangles_of(given["triangles"], model.vertices.size());
  return model;
}

constexpr std::tuple kModelFacts{
    fact<&Model::spacing>(
        "Metres. The vertices are samples of a mesh, and no place of its surface is farther than "
        "this from one of them. 0 where the model is no sampled mesh."),
    fact<&Model::file_axes>(
        "The axes of the model's file that pointed ahead and up before the model was turned, such "
        "as ('+y', '+z'); ('+x', '+z') where it was not turned.")};

void add_shape(py::module_& module) {
  auto shape = add_class<Model>(
      module, "Model", "A model: points, or a surface of triangles, which is searched as it is.",
      kModelFacts);
  shape.attr("NO_SOLID") = kNoSolid;
  shape
      .def(py::init(&make_model),
           R"(__init__(self, vertices: Array, triangles: Array = (), spacing: From0 = 0.0)
--

Make a model of arrays.

vertices: n x 3 real numbers, metres, in the model's own frame.
triangles: m x 3 indices of vertices. Empty: the vertices themselves are the model.
spacing: where the vertices are samples of a mesh, how far its surface may be from them, metres.)")
      .def_property_readonly(
          "vertices", member_array<&Model::vertices, Model>,
          "The points of the model, or the corners of its triangles: n x 3 float64, metres.")
      .def_property_readonly(
          "triangles", member_array<&Model::triangles, Model>,
          "The triangles, each as three indices of vertices: n x 3 uint32. Empty where the model "
          "is its points.")
      .def_property_readonly(
          "solid_of", member_array<&Model::solid_of, Model>,
          "The number of the solid that each triangle belongs to, or NO_SOLID: n uint32. Empty "
          "where nothing has an inside.");
  add_repr(shape, [](const Model& m) {
    return "<Model: " + std::to_string(m.vertices.size()) + " vertices, " +
           std::to_string(m.triangles.size()) + " triangles>";
  });
}

/// Reads the file of the argument `path` as a model. read: read_model() or read_model_points().
template <typename Read>
auto model_of_file(const py::kwargs& given, ModelOptions options, Read read) {
  set_fields(kModelFields, given, options);
  const EnvironmentUnit environment = take_environment_unit(given, options);
  return read_noting(given, [&, file = path_of(given["path"])](auto* noted) {
    auto model = read(file, options, noted);
    check_unit_is_given(file, environment, options.unit, *noted);
    return model;
  });
}

py::array_t<double> read_model_points(const py::kwargs& given) {
  return to_array(model_of_file(given, {.as = ModelAs::kPoints}, [](const auto&... arguments) {
    return read_model_points(arguments...);
  }));
}

Model read_model(const py::kwargs& given) {
  ModelOptions options;
  set_fields(kKindOfModel, given, options);
  return model_of_file(given, options,
                       [](const auto&... arguments) { return read_model(arguments...); });
}

py::array_t<double> read_outline(const py::kwargs& given) {
  OutlineOptions options;
  take<&OutlineOptions::mirror, &OutlineOptions::unit>(given, options);
  const auto corners = read_noting(given, [&, file = path_of(given["path"])](auto* noted) {
    return read_outline(file, options, noted);
  });
  py::array_t<double> array({static_cast<py::ssize_t>(corners.size()), py::ssize_t{2}});
  double* at = array.mutable_data();
  for (const auto& [y, z] : corners) {
    *at++ = y;
    *at++ = z;
  }
  return array;
}

void refuse_none(const py::handle& object) {
  if (!object.is_none()) return;
  throw UsageError(
      "model: expected a Model or an array of points, n x 3, or () where bodies are given; found "
      "None");
}

}  // namespace

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

std::string model_words(const py::object& object) {
  if (py::isinstance<Model>(object)) {
    const std::size_t triangles = object.cast<const Model&>().triangles.size();
    if (triangles > 0) return std::to_string(triangles) + " model triangles";
    return std::to_string(object.cast<const Model&>().vertices.size()) + " model points";
  }
  return std::to_string(py::len(object)) + " model points";
}

void add_model(py::module_& module) {
  add_shape(module);
  module.def(
      "box_model",
      [](const py::kwargs& given) {
        const auto side = [&](const char* name) { return argument<double>(given, name); };
        return box_model(side("length"), side("width"), side("height"));
      },
      R"(box_model(length: Above0, width: Above0, height: Above0)
--

Make a closed box that stands on z = 0, with its middle over the origin. Returns a Model, a solid.

length, width, height: its sides along x, y and z, metres.)");
  module.def(
      "outline_model",
      [](const py::kwargs& given) {
        return outline_model(outline_of(given["outline"], "outline"),
                             argument<double>(given, "rear"), argument<double>(given, "front"));
      },
      R"(outline_model(outline: Outline, rear: Number, front: Number)
--

Make a closed solid with this cross-section, such as a load or a clearance gauge. Returns a Model.

outline: corners y, z of a simple polygon, n x 2, metres; y is to the left, z up.
rear, front: where the solid begins and ends along x, metres.)");
  module.def(
      "read_outline", &read_outline,
      R"(read_outline(path: Path, *, mirror: Flag = False, unit: Unit = 0.0, messages: Notes = None)
--

Read an outline from a file of text, two numbers in each line. Returns its corners y, z in metres.

path: the file, with the names y,z in its first line or none.
mirror: the file has height,half_width of one half of a symmetric outline.
unit: unit of the file: 'mm', 'cm', 'm', 'in', 'ift', 'us-ft' or its length in metres; 0: metres.
messages: a list to which a warning of half an outline is appended.)");
  module.def("read_model_points", &read_model_points,
             ("read_model_points(path: Path, *, " + signature_of(kModelFields) +
              R"DOC(, environment_unit: EnvironmentUnit = None, messages: Notes = None)
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
  module.def("read_model", &read_model,
             ("read_model(path: Path, model_as: OneOf('auto', 'surface', 'solid', 'points') = "
              "'auto', *, " +
              signature_of(kModelFields) +
              R"DOC(, environment_unit: EnvironmentUnit = None, messages: Notes = None)
--

Read a model, to be searched as it is. Returns a Model.

path: the file.
)DOC" + lines_of(kKindOfModel) +
              lines_of(kModelFields) +
              R"DOC(environment_unit, messages: as read_model_points() takes them.)DOC")
                 .c_str());
}

}  // namespace clearway::python
