#pragma once

#include <array>
#include <tuple>

#include "clearway/model.hpp"
#include "core/describe/field.hpp"

namespace clearway {

template <>
inline constexpr std::array kChoices<ModelAs>{
    Choice<ModelAs>{"auto", ModelAs::kAuto}, Choice<ModelAs>{"surface", ModelAs::kSurface},
    Choice<ModelAs>{"solid", ModelAs::kSolid}, Choice<ModelAs>{"points", ModelAs::kPoints}};
template <>
inline constexpr std::array kChoices<Axis>{
    Choice<Axis>{"+x", Axis::kPlusX}, Choice<Axis>{"-x", Axis::kMinusX},
    Choice<Axis>{"+y", Axis::kPlusY}, Choice<Axis>{"-y", Axis::kMinusY},
    Choice<Axis>{"+z", Axis::kPlusZ}, Choice<Axis>{"-z", Axis::kMinusZ},
    Choice<Axis>{"x", Axis::kPlusX},  Choice<Axis>{"y", Axis::kPlusY},
    Choice<Axis>{"z", Axis::kPlusZ}};

/// What a model is searched as, which only a search has to be given: others know it from its
/// result.
inline constexpr std::tuple kKindOfModel{Field{
    .member = &ModelOptions::as,
    .key = "model_as",
    .campaign_key = "as",
    .option = "--model-as",
    .group = OptionGroup::kModel,
    .value_name = "KIND",
    .help = "surface: search the triangles of a mesh as they are. solid: and what its closed parts "
            "enclose. points: search points on its surface; the answer says how far they are "
            "apart. auto: solid for a mesh whose parts are all closed, surface for other meshes, "
            "points "
            "for other files (default)",
    .doc =
        "'auto': a mesh whose parts are all closed as a solid, another mesh as its surface, any\n"
        "    other file as its points; with spacing or vertices_only a mesh as points.\n"
        "    'surface': the triangles of the mesh; a file without any is refused.\n"
        "    'solid': the same, and what its closed parts enclose; a mesh without any is refused.\n"
        "    'points': samples of the surface of a mesh, or the points of the file."}};

/// How the file of a model is read.
inline constexpr std::tuple kShapeOfModel{
    Field{.member = &ModelOptions::unit,
          .key = "unit",
          .option = "--model-unit",
          .group = OptionGroup::kUnits,
          .help = "Unit of the model's file; ft is the environment's foot, ift the international "
                  "and us-ft the US survey foot",
          .usual = "that of the environment",
          .doc = "The unit of the file: metres, or a name: 'mm', 'cm', 'm', 'in', 'ft' (the\n"
                 "    environment's foot, also METRES_PER_FOOT), 'ift' (the international foot) or "
                 "'us-ft' (the US\n    survey foot); 0: as the file says, or else that of the "
                 "environment."},
    Field{.member = &ModelOptions::spacing,
          .key = "spacing",
          .option = "--model-spacing",
          .group = OptionGroup::kModel,
          .help = "Search points of a mesh, and no place of its surface is farther than this from "
                  "one",
          .usual = "a quarter of the radius",
          .doc = "How closely a mesh is sampled, metres: no place of its surface is farther from a "
                 "point.\n    A mesh that becomes points needs a spacing."},
    Field{.member = &ModelOptions::vertices_only,
          .key = "vertices_only",
          .campaign_key = "vertices",
          .option = "--model-vertices",
          .group = OptionGroup::kModel,
          .help = "Take the vertices of a mesh alone as the model, not its surface",
          .doc = "Takes the vertices of a mesh alone, and not its surface."}};

/// The unit of a model's file for commands that have no environment.
inline constexpr Field kUnitWithoutEnvironment{
    .member = &ModelOptions::unit,
    .key = "unit",
    .option = "--unit",
    .group = OptionGroup::kUnits,
    .help = "Unit of the file; ft and ift are the international foot, us-ft the US survey foot",
    .usual = "m"};

/// The axes of a model's file, to which it is turned when it is read.
inline constexpr std::tuple kTurnOfModel{
    Field{.member = &ModelOptions::forward,
          .key = "forward",
          .option = "--forward",
          .group = OptionGroup::kUnits,
          .help = "Axis of the model's file that points ahead, for example +y; the model is turned "
                  "so that it becomes x",
          .usual = "+x",
          .doc = "The axis of the file that points ahead, such as '+y' or '-z'; the model is "
                 "turned so that\n    it becomes x."},
    Field{.member = &ModelOptions::up,
          .key = "up",
          .option = "--up",
          .group = OptionGroup::kUnits,
          .help = "Axis of the model's file that points up, for example +y; the model is turned so "
                  "that it becomes z",
          .usual = "+z",
          .doc = "The axis of the file that points up; the model is turned so that it becomes z."}};

/// How a model is read, but for what it becomes.
inline constexpr std::tuple kModelFields = std::tuple_cat(kShapeOfModel, kTurnOfModel);

}  // namespace clearway
