#include "clearway/model.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "cli/commands.hpp"
#include "cli/support/console.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "core/geometry/point_box.hpp"
#include "core/util/format.hpp"
#include "io/files/pending_file.hpp"
#include "io/models/mesh_facts.hpp"
#include "io/models/model_input.hpp"
#include "io/models/sample_mesh.hpp"
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

ordered_json json_of(const Box& box) {
  return {{"lo", {box.lo.x, box.lo.y, box.lo.z}}, {"hi", {box.hi.x, box.hi.y, box.hi.z}}};
}

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
                   {"bounds", json_of(box)},
                   {"size", {box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z}}};
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

void write_points(const Model& model, const std::filesystem::path& path) {
  const File file = File::create(path);
  PlyOutput header{.points = model.vertices.size()};
  if (model.spacing > 0) {
    header.comment = std::string(kSpacingComment) + format_number(model.spacing);
  }
  PlyWriter writer(file, header);
  writer.write(model.vertices);
  writer.finish();
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
      write_points(model, output->partial());
      output->publish();
    }
  } else {
    messages = input.messages;
  }
  for (const Message& message : messages) log_message(message);
  print(options.json ? facts.dump(2) + "\n" : facts_text(facts));
}

}  // namespace

void add_model(CLI::App& program) {
  const auto options = std::make_shared<ModelCommand>();
  CLI::App* command = program.add_subcommand(
      "model", "Say what is in a model's file, and sample a mesh to the points that run takes");
  command
      ->add_option("IN", options->input,
                   "A mesh in STL, OBJ, PLY or OFF, or points in a scan's format")
      ->type_name("FILE")
      ->required();
  command->add_option("-o,--output", options->output, "The model's points in metres, a PLY file")
      ->type_name("FILE");
  CLI::Option* spacing = options->lengths.add(
      *command, "--spacing,--model-spacing", options->how.spacing,
      "Spacing of the points on a mesh: no place of its surface is farther than this from "
      "one");
  add_model_unit(*command, "--unit,--model-unit", options->how.unit);
  command
      ->add_flag("--vertices,--model-vertices", options->how.vertices_only,
                 "Take the vertices of a mesh alone, not its surface")
      ->excludes(spacing);
  options->lengths.add(*command, "--above,--model-above", options->how.above,
                       "Leave out the points whose z is below this", LengthRange::kAny);
  command->add_flag("--force", options->force, "Overwrite an existing output");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->footer(
      "clearway run searches the mesh itself. With --model-as points it makes such points.\n"
      "Example: clearway model car.stl --unit mm -o car.ply --spacing 0.025");
  command->callback(
      [options] { run_stoppable(options->output, kStartsAgain, [&] { run_model(*options); }); });
}

}  // namespace clearway::tool
