#include "cli/model.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "clearway/model.hpp"
#include "clearway/outline.hpp"
#include "cli/commands.hpp"
#include "cli/support/console.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "core/geometry/point_box.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "io/files/pending_file.hpp"
#include "io/models/mesh/mesh_writer.hpp"
#include "io/models/mesh_facts.hpp"
#include "io/models/model_input.hpp"
#include "io/models/sample_mesh.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/ply/ply_header.hpp"
#include "io/scans/ply/ply_writer.hpp"

namespace clearway::tool {
namespace {

using nlohmann::ordered_json;

struct ModelCommand {
  std::filesystem::path input, output;
  ModelOptions how;
  LengthOptions lengths;
  bool force = false;
  bool json = false;
};

ordered_json describe_mesh(const ModelInput& input) {
  const MeshFacts facts = facts_of(input.mesh);
  const std::uint64_t drawn = input.remarks.segments + input.remarks.single_points;
  return {{"triangles", input.mesh.triangles.size() - drawn},
          {"segments", input.remarks.segments},
          {"single_points", input.remarks.single_points},
          {"area", facts.area},
          {"watertight", facts.watertight()},
          {"edges", facts.edges},
          {"open_edges", facts.open_edges},
          {"crowded_edges", facts.crowded_edges},
          {"flipped_edges", facts.flipped_edges},
          {"flat_triangles", facts.flat_triangles - drawn},
          {"parts", facts.parts}};
}

ordered_json describe_points(const std::vector<Vec3>& points) {
  const PointGaps gaps = gaps_of(points);
  return {{"median_gap", gaps.median},
          {"largest_gap", gaps.largest},
          {"repeated_points", gaps.repeated}};
}

ordered_json describe(const ModelInput& input) {
  const Box box = box_of(input.mesh.vertices);
  ordered_json out{{"kind", input.is_mesh() ? "mesh" : "points"},
                   {"vertices", input.mesh.vertices.size()},
                   {"bounds", box},
                   {"size", box.size()}};
  out.update(input.is_mesh() ? describe_mesh(input) : describe_points(input.mesh.vertices));
  return out;
}

/// The facts of a model in lines, without those that are as they should be.
std::string facts_text(const ordered_json& facts) {
  std::string text;
  const auto line = [&text](const char* name, const std::string& value) {
    text += fmt::format("{:<16}  {}\n", name, value);
  };
  const auto count = [&](const char* key) { return format_count(facts[key].get<std::uint64_t>()); };
  const auto three = [](const ordered_json& v) {
    return fmt::format("{:.4f} {:.4f} {:.4f} m", v[0].get<double>(), v[1].get<double>(),
                       v[2].get<double>());
  };
  line("size", three(facts["size"]));
  line("from", three(facts["bounds"]["lo"]));
  line("to", three(facts["bounds"]["hi"]));
  line("vertices", count("vertices"));
  if (facts["kind"] == "points") {
    line("nearest other",
         fmt::format("median {:.4g} m, largest {:.4g} m", facts["median_gap"].get<double>(),
                     facts["largest_gap"].get<double>()));
    if (facts["repeated_points"] > 0) line("repeated", count("repeated_points"));
  } else {
    line("triangles", count("triangles"));
    if (facts["segments"] > 0) line("line segments", count("segments"));
    if (facts["single_points"] > 0) line("single points", count("single_points"));
    if (facts["flat_triangles"] > 0) line("without area", count("flat_triangles"));
    line("area", fmt::format("{:.6g} m2", facts["area"].get<double>()));
    line("parts", count("parts"));
    line("watertight", facts["watertight"] == true
                           ? "yes"
                           : "no: of " + count("edges") + " edges " + count("open_edges") +
                                 " are open, " + count("crowded_edges") +
                                 " are of more than two triangles, " + count("flipped_edges") +
                                 " are of two that are turned against each other");
  }
  if (facts.contains("points")) line("model points", count("points"));
  return text;
}

/// in_metres: whether the unit of the model's file is known, so that the points are in metres.
void write_points(const Model& model, bool in_metres, const std::filesystem::path& path) {
  const File file = File::create(path);
  PlyOutput header{.points = model.vertices.size()};
  if (in_metres) header.comments.push_back(std::string(kUnitComment) + "m");
  if (model.spacing > 0) {
    header.comments.push_back(std::string(kSpacingComment) + format_number(model.spacing));
  }
  PlyWriter writer(file, header);
  writer.write(model.vertices);
  writer.finish();
}

/// A solid that is made from a few numbers.
struct MadeModel {
  std::filesystem::path outline, output;
  OutlineOptions how;
  Vec3 box{};
  std::optional<std::array<double, 2>> x;
  LengthOptions lengths;
  bool force = false;
};

void write_solid(const MadeModel& options, const Model& solid) {
  check_mesh_name(options.output);
  PendingFile output(options.output, options.force);
  write_mesh(solid, options.output, File::create(output.partial()));
  output.publish();
  const MeshFacts facts = facts_of({solid.vertices, solid.triangles});
  const Box box = box_of(solid.vertices);
  double volume = 0;
  for (const auto& [a, b, c] : solid.triangles) {
    volume += dot(solid.vertices[a] - box.lo,
                  cross(solid.vertices[b] - box.lo, solid.vertices[c] - box.lo)) /
              6;
  }
  spdlog::info("{}: a closed solid of {} and {}, {} x {} x {} m, {} m2, {} m3",
               options.output.string(), counted(solid.vertices.size(), "corner"),
               counted(solid.triangles.size(), "triangle"), format_brief(box.hi.x - box.lo.x),
               format_brief(box.hi.y - box.lo.y), format_brief(box.hi.z - box.lo.z),
               format_brief(facts.area), format_brief(volume));
}

void add_output(CLI::App& command, MadeModel& options) {
  add_file(command, "-o,--output", options.output, "The solid in metres: a mesh in OFF or PLY")
      ->required();
  command.add_flag("--force", options.force, "Overwrite an existing output");
}

void add_box(CLI::App& model) {
  const auto options = std::make_shared<MadeModel>();
  CLI::App* command = model.add_subcommand(
      "box", "Make a box that stands on z = 0 with its middle over the origin");
  options->lengths
      .add(*command, "size", options->box, "Length along x, width along y and height along z")
      ->type_name("L,W,H")
      ->required();
  add_output(*command, *options);
  command->footer(
      "clearway run takes a box without a file, too: --model box:30,5,4.3\n"
      "Example: clearway model box 30,5,4.3 -o load.off");
  command->callback([options] {
    options->lengths.convert(1);
    const auto& [length, width, height] = options->box;
    write_solid(*options, box_model(length, width, height));
  });
}

void add_outline(CLI::App& model) {
  const auto options = std::make_shared<MadeModel>();
  CLI::App* command = model.add_subcommand(
      "outline", "Make a solid from its cross-section, such as a clearance gauge or a load");
  add_file(*command, "IN", options->outline,
           "The outline as text: y,z of each corner in a line, or with --mirror "
           "height,half_width")
      ->required();
  options->lengths
      .add(*command, "--x", options->x, "Where the solid begins and ends along the vehicle")
      ->type_name("REAR,FRONT")
      ->required();
  command->add_flag("--mirror", options->how.mirror,
                    "The file has height,half_width of the one half of a symmetric outline");
  add_unit_alone(*command, "--unit", options->how.unit);
  add_output(*command, *options);
  command->footer("Example: clearway model outline gauge.csv --mirror --x=-2,28 -o gauge.off");
  command->callback([options] {
    refuse_overwriting(options->output, {options->outline});
    options->lengths.convert(1);
    std::vector<Message> messages;
    const auto outline = read_outline(options->outline, options->how, &messages);
    for (const Message& message : messages) log_message(message);
    try {
      write_solid(*options, outline_model(outline, (*options->x)[0], (*options->x)[1]));
    } catch (const UsageError& error) {
      throw UsageError(options->outline.string() + ": " + error.what());
    }
  });
}

void run_model(const ModelCommand& options) {
  std::optional<PendingFile> output;
  if (!options.output.empty()) {
    refuse_overwriting(options.output, {options.input});
    output.emplace(options.output, options.force);
  }
  const ModelInput input = read_model_input(options.input, options.how);
  ordered_json facts = describe(input);
  std::vector<Message> messages;
  const bool sampled = output || !input.is_mesh() || options.how.spacing > 0;
  if (sampled) {
    const Model model = points_of(input, options.how, messages);
    if (model.spacing > 0) facts["spacing"] = model.spacing;
    facts["points"] = model.vertices.size();
    if (output) {
      const bool in_metres = options.how.unit.is_known() || input.declared_unit.is_known();
      write_points(model, in_metres, output->partial());
      output->publish();
    }
  } else {
    messages = input.messages;
  }
  for (const Message& message : messages) log_message(message);
  print(options.json ? indented_text(facts) : facts_text(facts));
}

/// Adds the file of a model, and how it is read.
void add_reading(CLI::App& command, ModelCommand& options) {
  add_file(command, "IN", options.input,
           "A mesh in STL, OBJ, PLY or OFF, points in a scan's format, or box:L,W,H");
  add_unit_alone(command, "--unit,--model-unit", options.how.unit);
  add_turn_options(command, options.how.forward, options.how.up);
  command.add_flag("--json", options.json, "Print one JSON object");
}

void add_info_of_model(CLI::App& model) {
  const auto options = std::make_shared<ModelCommand>();
  CLI::App* command = model.add_subcommand(
      "info", "Say what is in a model's file: its size, its parts, and whether they are closed");
  add_reading(*command, *options);
  command->get_option("IN")->required();
  command->footer("Example: clearway model info car.obj");
  command->callback([options] { run_model(*options); });
}

}  // namespace

ordered_json description_of_model(const std::filesystem::path& file) {
  ordered_json description = describe(read_model_input(file, {}));
  description["more"] = "clearway model info " + file.filename().string();
  return description;
}

void add_model(CLI::App& program) {
  const auto options = std::make_shared<ModelCommand>();
  CLI::App* command = program.add_subcommand(
      "model", "Say what is in a model's file, sample a mesh to points, make a box or a gauge");
  add_reading(*command, *options);
  add_file(*command, "-o,--output", options->output,
           "The model's points, a PLY file, in metres where the unit of IN is known");
  CLI::Option* spacing = options->lengths.add(
      *command, "--spacing,--model-spacing", options->how.spacing,
      "Spacing of the points on a mesh: no place of its surface is farther than this from "
      "one");
  command
      ->add_flag("--vertices,--model-vertices", options->how.vertices_only,
                 "Take the vertices of a mesh alone, not its surface")
      ->excludes(spacing);
  command->add_flag("--force", options->force, "Overwrite an existing output");
  command->footer(
      "clearway run searches the mesh itself. With --model-as points it makes such points.\n"
      "Example: clearway model car.stl --unit mm -o car.ply --spacing 0.025");
  add_info_of_model(*command);
  add_box(*command);
  add_outline(*command);
  command->callback([options, command] {
    if (!command->get_subcommands().empty()) return;
    if (options->input.empty()) throw CLI::RequiredError("IN");
    run_stoppable(options->output, kStartsAgain, [&] { run_model(*options); });
  });
}

}  // namespace clearway::tool
