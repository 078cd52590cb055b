#include "io/models/model_input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/model.hpp"
#include "clearway/outline.hpp"
#include "core/geometry/axes.hpp"
#include "core/util/format.hpp"
#include "io/files/text_number.hpp"
#include "io/models/mesh/mesh_reader.hpp"
#include "io/models/mesh_facts.hpp"
#include "io/models/sample_mesh.hpp"
#include "io/models/surface_of.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/point_reader.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {
namespace {

constexpr std::string_view kBoxPrefix = "box:";
constexpr double kReportedBend = 0.1;  // share of the spacing above which a bend is reported

void add_note(std::vector<Message>& messages, const ModelInput& input, const std::string& text,
              MessageNumbers numbers = {}) {
  messages.push_back(plain_note(input.path.string() + ": " + text, std::move(numbers)));
}

void warn(std::vector<Message>& messages, const ModelInput& input, WarningCode code,
          const std::string& text, MessageNumbers numbers) {
  messages.push_back(warning(code, input.path.string() + ": " + text, std::move(numbers)));
}

/// Appends the points of a batch, without those that are withheld. first: number of the batch's
/// first record, where records without a point count too.
void append(const PointBatch& batch, const CloudInfo& info, std::uint64_t first,
            const std::string& name, std::vector<Vec3>& points) {
  for (std::size_t i = 0; i < batch.quanta.size(); ++i) {
    const auto& q = batch.quanta[i];
    if (!batch.is_withheld(i)) {
      points.push_back(position(*info.quantisation, q[0], q[1], q[2]));
    }
  }
  std::size_t absent = 0;
  for (std::size_t i = 0; i < batch.positions.size(); ++i) {
    if (absent < batch.absent.size() && batch.absent[absent] == i) {
      ++absent;
      continue;
    }
    const Vec3& p = batch.positions[i];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      refuse(name, "model point " + std::to_string(first + i) + " (counted from 0) is " +
                       shown_place(p) + "; expected finite coordinates");
    }
    points.push_back(p);
  }
}

/// Throws InputError where the file says something of its unit or of the place of its points that
/// is not read. has_unit: whether the unit is given.
void refuse_unread(const ModelInput& input, const CloudInfo& info, bool has_unit) {
  if (!info.unplaced.empty()) {
    refuse(input.path.string(), info.unplaced + std::string(kExpectedPlaced));
  }
  const std::string unread =
      info.crs_unread.empty() ? info.unit_unread : info.crs_unread + " is not read";
  if (has_unit || info.unit != LengthUnit::kUnknown || unread.empty()) return;
  refuse(input.path.string(),
         unread + ". So its unit is not known, expected one that is read. --model-unit names it");
}

void read_points(ModelInput& input, bool has_unit) {
  const auto reader = open_point_file(input.path);
  PointBatch batch;
  std::uint64_t withheld = 0;
  for (std::uint64_t first = 0; reader->read(batch); first += batch.size()) {
    append(batch, reader->info(), first, input.path.string(), input.mesh.vertices);
    for (std::size_t i = 0; i < batch.flags.size(); ++i) withheld += batch.is_withheld(i) ? 1 : 0;
  }
  input.messages = reader->info().remarks;
  if (withheld > 0) {
    warn(input.messages, input, "withheld-model-points",
         counted(withheld, "point") + " with the flag `withheld` " +
             (withheld == 1 ? "is" : "are") + " left out of the model as deleted",
         {{"points", withheld}});
  }
  input.sampled_spacing = reader->info().model_spacing;
  const CloudInfo& info = reader->info();
  refuse_unread(input, info, has_unit);
  const std::string trouble = heights_trouble(info.height_unit, info.unit);
  if (!trouble.empty()) {
    refuse(input.path.string(), trouble + "; expected one unit for all of them");
  }
  const double metres = metres_of(info.unit);
  input.declared_unit = info.any_foot ? FileUnit(metres) : FileUnit::exactly(metres);
  if (reader->info().faces > 0) {
    add_note(input.messages, input,
             "its " + format_count(reader->info().faces) + " faces are left out");
  }
}

/// Makes a file that draws only single points a model of these points, like a scan's file.
void take_single_points(ModelInput& input) {
  const std::uint64_t drawn = input.remarks.single_points;
  if (drawn == 0 || drawn != input.mesh.triangles.size()) return;
  std::vector<Vec3> points;
  std::vector<bool> is_drawn(input.mesh.vertices.size());
  for (const auto& point : input.mesh.triangles) {
    points.push_back(input.mesh.vertices[point[0]]);
    is_drawn[point[0]] = true;
  }
  const auto loose = static_cast<std::uint64_t>(std::ranges::count(is_drawn, false));
  if (loose > 0) input.messages.push_back(loose_vertices_warning(input, loose));
  input.mesh = {std::move(points), {}};
}

/// Reads the file as a mesh; returns false where it is none. with_faces: whether the faces are
/// wanted; otherwise the vertices alone are kept as points.
bool read_as_mesh(ModelInput& input, bool with_faces) {
  File file = File::open_for_reading(input.path);
  const auto format = mesh_format_of(file, input.path);
  if (!format) return false;
  MeshFile read = read_mesh(InputBuffer(std::move(file), InputBuffer::Access::kSeek), *format);
  if (format == MeshFormat::kPly && read.mesh.triangles.empty()) return false;
  input.mesh = std::move(read.mesh);
  input.declared_unit = read.unit;
  input.remarks = std::move(read.remarks);
  if (with_faces) {
    take_single_points(input);
  } else {
    input.between_vertices = std::exchange(input.mesh.triangles, {});
  }
  return true;
}

/// Warns where the model's and the environment's feet differ so much that a model in the scan's
/// coordinates would be elsewhere with the other foot.
void warn_of_two_feet(ModelInput& input, double unit, double environment_unit, double largest) {
  if (!is_foot(unit) || !is_foot(environment_unit)) return;
  const double moved = feet_apart(largest * environment_unit, unit, environment_unit);
  if (!(moved > kFeetApart)) return;
  warn(input.messages, input, "two-feet",
       two_feet_text("its coordinates", unit, environment_unit, moved), {{"metres", moved}});
}

/// Converts the model into the environment's unit, where the file's unit is known.
void scale(ModelInput& input, const ModelOptions& options) {
  const FileUnit named = options.unit.is_known() ? options.unit : input.declared_unit;
  const double unit = named.metres_in(options.environment_unit);
  if (unit == 0) return;
  if (unit == options.environment_unit) {
    if (is_foot(unit)) {
      add_note(input.messages, input,
               "its coordinates are in " + units_text(unit) +
                   ", as the environment is, and are taken as they are",
               {{"metres", unit}});
    }
    return;
  }
  const UnitFactor scaled(unit, options.environment_unit);
  double largest = 0;
  for (Vec3& p : input.mesh.vertices) {
    const Vec3 place{scaled(p.x), scaled(p.y), scaled(p.z)};
    if (!std::isfinite(place.x) || !std::isfinite(place.y) || !std::isfinite(place.z)) {
      refuse(
          input.path.string(),
          shown_place(p) + " is too large in the environment's unit; expected finite coordinates");
    }
    p = place;
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  input.remarks.largest_bend *= scaled.factor();
  input.sampled_spacing *= scaled.factor();
  warn_of_two_feet(input, unit, options.environment_unit, largest);
  if (options.environment_unit_is_assumed) {
    warn(input.messages, input, "unit-assumed", unit_assumed_text("its coordinates", unit),
         {{"metres", unit}});
  }
  if (options.unit.is_known()) return;
  add_note(input.messages, input,
           "its unit is " + format_number(unit) + " m, the environment's " +
               format_number(options.environment_unit) + " m: its coordinates are converted",
           {{"metres", unit}});
}

/// Turns the model so that its x axis points ahead and its z axis up.
void turn(ModelInput& input, const ModelOptions& options) {
  const ModelAxes axes{options.forward, options.up};
  if (!axes.need_turn()) return;
  for (Vec3& p : input.mesh.vertices) p = turned(p, axes);
  add_note(input.messages, input,
           std::string("its ") + name_of(axes.forward) + " axis points ahead and its " +
               name_of(axes.up) + " axis up: it is turned so that these are x and z");
}

void check_axes(const ModelOptions& options) {
  if (!along_one_line(options.forward, options.up)) return;
  throw UsageError("forward and up lie along the same axis; expected two different axes");
}

/// Adds remarks on a mesh, or on single vertices in a mesh's file, to the messages.
void tell_remarks(ModelInput& input) {
  const MeshRemarks& remarks = input.remarks;
  if (remarks.last_line_open) {
    add_note(input.messages, input,
             "the last line has no line break; make sure that the file is whole");
  }
  if (remarks.crossing > 0) {
    warn(input.messages, input, "mesh-crossing-faces",
         format_count(remarks.crossing) + " faces have an outline that crosses itself, the first " +
             remarks.first_crossing + "; what they mean is not certain",
         {{"faces", remarks.crossing}});
  }
}

Model sampled(const ModelInput& input, const ModelOptions& options,
              std::vector<Message>& messages) {
  const double spacing = options.spacing > 0 ? options.spacing : default_spacing(options.radius);
  if (spacing == 0) {
    refuse(input.path.string(),
           "a mesh of " + contents_of(input) + "; expected a spacing for the points of its surface",
           Remedy::kModelSpacing);
  }
  const TriangleMesh surface = kept_surface(input, messages);
  Model shape = sample_mesh(surface, spacing, input.path.string());
  shape.spacing = spacing;
  tell_bend(input, spacing, "the spacing", messages);
  add_note(messages, input,
           "a mesh of " + contents_of(input) + ", sampled to " +
               format_count(shape.vertices.size()) +
               " points; no place of its surface is farther than " + format_number(spacing) +
               " m from one",
           {{"triangles", surface.triangles.size()},
            {"points", shape.vertices.size()},
            {"spacing", spacing}});
  return shape;
}

/// A model of all vertices of a mesh, or of all points of another file.
Model vertices_of(const ModelInput& input, std::vector<Message>& messages) {
  Model shape = input.mesh.vertices;
  shape.spacing = input.sampled_spacing;
  if (shape.spacing > 0) {
    add_note(messages, input,
             "samples of a mesh; no place of its surface is farther than " +
                 format_number(shape.spacing) + " m from one",
             {{"spacing", shape.spacing}});
  }
  if (!input.between_vertices.empty()) {
    shape.spacing = distance_to_vertices({input.mesh.vertices, input.between_vertices});
    add_note(messages, input,
             "the model is the vertices of a mesh, " + format_count(input.mesh.vertices.size()) +
                 ", and its faces are left out; places of its surface are up to " +
                 format_brief(shape.spacing) + " m from the nearest vertex",
             {{"spacing", shape.spacing}});
  }
  return shape;
}

/// Makes the box of "box:LENGTH,WIDTH,HEIGHT", in metres where no unit is named.
void make_box(ModelInput& input) {
  const std::string name = input.path.string();
  const std::string_view all = std::string_view(name).substr(kBoxPrefix.size());
  std::string_view sizes = all;
  std::array<double, 3> size{};
  bool sound = true;
  for (std::size_t k = 0; k < 3 && sound; ++k) {
    const std::size_t end = k < 2 ? sizes.find(',') : sizes.size();
    const auto length =
        end == std::string_view::npos ? std::nullopt : length_of(sizes.substr(0, end));
    sound = length && length->value > 0;
    if (!sound) break;
    size[k] = length->value;
    sizes.remove_prefix(std::min(end + 1, sizes.size()));
  }
  if (!sound) {
    throw UsageError(name + ": expected a box as box:LENGTH,WIDTH,HEIGHT, three lengths above 0, " +
                     "for example box:30,5,4.3; a file of this name is ./" + name);
  }
  Model box = box_model(size[0], size[1], size[2]);
  input.mesh = {std::move(box.vertices), std::move(box.triangles)};
  input.declared_unit = FileUnit::exactly(1);
}

}  // namespace

bool names_box(const std::filesystem::path& model) {
  return std::string_view(model.native()).starts_with(kBoxPrefix);
}

void tell_bend(const ModelInput& input, double allowed, const std::string& of_what,
               std::vector<Message>& messages) {
  const double bend = input.remarks.largest_bend;
  if (!(bend > kReportedBend * allowed)) return;
  const std::string text = "a face with more than three corners is bent by " + format_brief(bend) +
                           " m (" + input.remarks.largest_bend_at +
                           "); how it is cut into triangles changes the surface by about as much";
  if (bend <= allowed) return add_note(messages, input, text);
  warn(messages, input, "mesh-bent-faces",
       text + ", which is more than " + of_what + ". Export the mesh as triangles",
       {{"bend", bend}, {"spacing", allowed}});
}

std::string contents_of(const ModelInput& input) {
  const auto& [segments, points] = std::pair(input.remarks.segments, input.remarks.single_points);
  const std::uint64_t triangles = input.mesh.triangles.size() - segments - points;
  if (triangles == 0 && segments > 0) {
    return counted(segments, "line segment") +
           (points > 0 ? " and " + counted(points, "single point") : "");
  }
  std::string text = counted(triangles, "triangle");
  if (segments > 0) text += (points > 0 ? ", " : " and ") + counted(segments, "line segment");
  if (points > 0) text += " and " + counted(points, "single point");
  return text;
}

Message loose_vertices_warning(const ModelInput& input, std::uint64_t vertices) {
  return warning("loose-vertices", {{"vertices", vertices}},
                 "{}: {}{} to no face, line or point of the file, and {} not part of the model. If "
                 "they are meant to show a part of the vehicle, such as a mast, the search does "
                 "not see it: join them by lines in the program that made the file",
                 input.path.string(), counted(vertices, "vertex", "vertices"),
                 vertices == 1 ? " belongs" : " belong", vertices == 1 ? "is" : "are");
}

ModelInput read_model_input(const std::filesystem::path& path, const ModelOptions& options) {
  if (!(options.unit.metres() >= 0) || !(options.environment_unit > 0)) {
    throw UsageError(path.string() + ": units of " + format_number(options.unit.metres()) +
                     " m and " + format_number(options.environment_unit) +
                     " m; expected numbers above 0");
  }
  check_axes(options);
  const bool with_faces = !options.vertices_only;
  ModelInput input;
  input.path = path;
  const bool box = names_box(path);
  if (box) make_box(input);
  if (box && !with_faces) input.between_vertices = std::exchange(input.mesh.triangles, {});
  const bool mesh = box || read_as_mesh(input, with_faces);
  if (!mesh) read_points(input, options.unit.is_known());
  if (input.mesh.vertices.empty()) {
    refuse(path.string(), "the model has no points; expected one at least");
  }
  scale(input, options);
  turn(input, options);
  tell_remarks(input);
  if (mesh && !input.is_mesh() && input.between_vertices.empty()) {
    add_note(input.messages, input,
             input.remarks.single_points > 0 ? "draws single points alone: the model is these, " +
                                                   format_count(input.mesh.vertices.size())
                                             : "has no faces: the model is its vertices, " +
                                                   format_count(input.mesh.vertices.size()));
  }
  return input;
}

void check_model_options(const ModelOptions& options) {
  check_axes(options);
  const bool surface = options.as == ModelAs::kSurface || options.as == ModelAs::kSolid;
  if (!surface || !options.asks_for_points()) return;
  throw UsageError(
      "a surface is searched as it is: a spacing, and the vertices alone, are of points",
      Remedy::kModelPoints);
}

Model points_of(const ModelInput& input, const ModelOptions& options,
                std::vector<Message>& messages) {
  messages.insert(messages.end(), input.messages.begin(), input.messages.end());
  return input.is_mesh() ? sampled(input, options, messages) : vertices_of(input, messages);
}

namespace {

Model model_of(MeshParts parts) {
  return {std::move(parts.mesh.vertices), std::move(parts.mesh.triangles),
          std::move(parts.solid_of)};
}

Model solids_of(const ModelInput& input, const ModelOptions& options,
                std::vector<Message>& messages) {
  MeshParts parts = parts_with_solids(surface_of(input, options, messages), input.path.string());
  add_note(messages, input, summary_of(parts));
  const std::string faults = faults_of(parts);
  if (!faults.empty()) {
    add_note(messages, input, "what keeps parts from being solid: " + faults);
  }
  return model_of(std::move(parts));
}

/// A mesh as a solid where all of its parts are closed, otherwise as a surface; says which and why.
Model closed_or_surface_of(const ModelInput& input, const ModelOptions& options,
                           std::vector<Message>& messages) {
  TriangleMesh surface = surface_of(input, options, messages);
  MeshParts parts = find_parts(surface);
  if (all_closed(parts)) {
    add_note(messages, input,
             (parts.solids == 1 ? std::string("it is")
                                : "all of its " + format_count(parts.solids) + " parts are") +
                 " closed, so it is searched as a solid: points inside it collide too");
    return model_of(std::move(parts));
  }
  add_note(messages, input,
           "searched as a surface, which has no inside, because " + why_not_closed(parts));
  return {std::move(surface.vertices), std::move(surface.triangles)};
}

}  // namespace

std::vector<Vec3> read_model_points(const std::filesystem::path& path, const ModelOptions& options,
                                    std::vector<Message>* messages) {
  ModelOptions how = options;
  how.as = ModelAs::kPoints;
  return read_model(path, how, messages).vertices;
}

Model read_model(const std::filesystem::path& path, const ModelOptions& options,
                 std::vector<Message>* messages) {
  check_model_options(options);
  const ModelInput input = read_model_input(path, options);
  std::vector<Message> remarks;
  Model shape;
  // The only place that decides what a file becomes.
  switch (options.as) {
    case ModelAs::kSolid:
      shape = solids_of(input, options, remarks);
      break;
    case ModelAs::kSurface: {
      TriangleMesh surface = surface_of(input, options, remarks);
      shape = {std::move(surface.vertices), std::move(surface.triangles)};
      break;
    }
    case ModelAs::kAuto:
      if (input.is_mesh() && !options.asks_for_points()) {
        shape = closed_or_surface_of(input, options, remarks);
        break;
      }
      [[fallthrough]];
    default:
      shape = points_of(input, options, remarks);
  }
  shape.file_axes = {options.forward, options.up};
  if (messages) messages->insert(messages->end(), remarks.begin(), remarks.end());
  return shape;
}

std::vector<Vec3> read_model_points(const std::filesystem::path& path,
                                    std::vector<Message>* messages) {
  return read_model_points(path, ModelOptions{}, messages);
}

}  // namespace clearway
