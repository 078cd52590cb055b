#include "io/model/model_input.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "core/util/unit_factor.hpp"
#include "io/formats/mesh/mesh_reader.hpp"
#include "io/formats/point_reader.hpp"
#include "io/model/sample_mesh.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

constexpr double kBendToTell = 0.1;  // of the spacing

void tell(std::vector<Message>& messages, const ModelInput& input, const std::string& text,
          std::vector<std::pair<std::string, double>> numbers = {}, std::string code = {}) {
  const auto severity = code.empty() ? Message::Severity::kNote : Message::Severity::kWarning;
  messages.push_back(
      {severity, std::move(code), input.path.string() + ": " + text, std::move(numbers)});
}

/// first: the number of the batch's first record, which counts those without a point too.
void append(const PointBatch& batch, const CloudInfo& info, std::uint64_t first,
            const std::string& name, std::vector<Vec3>& points) {
  for (const auto& q : batch.quanta) {
    points.push_back(position(*info.quantisation, q[0], q[1], q[2]));
  }
  std::size_t absent = 0;
  for (std::size_t i = 0; i < batch.positions.size(); ++i) {
    if (absent < batch.absent.size() && batch.absent[absent] == i) {
      ++absent;
      continue;
    }
    const Vec3& p = batch.positions[i];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      refuse(name, "model point " + std::to_string(first + i) + " (counted from 0) is (" +
                       shown(p.x) + ", " + shown(p.y) + ", " + shown(p.z) +
                       "); expected finite coordinates");
    }
    points.push_back(p);
  }
}

void read_points(ModelInput& input) {
  const auto reader = open_point_file(input.path);
  PointBatch batch;
  for (std::uint64_t first = 0; reader->read(batch); first += batch.size()) {
    append(batch, reader->info(), first, input.path.string(), input.mesh.vertices);
  }
  input.messages = reader->info().remarks;
  input.declared_unit = metres_of(reader->info().unit);
  if (reader->info().faces > 0) {
    tell(input.messages, input,
         "its " + format_count(reader->info().faces) + " faces are left out");
  }
}

/// Whether the file was read as a mesh; one without faces may be.
bool read_as_mesh(ModelInput& input, bool with_faces) {
  File file = File::open_for_reading(input.path);
  const auto format = mesh_format_of(file, input.path);
  if (!format || (format == MeshFormat::kPly && !with_faces)) return false;
  MeshFile read = read_mesh(InputBuffer(std::move(file), InputBuffer::Access::kSeek), *format);
  if (format == MeshFormat::kPly && read.mesh.triangles.empty()) return false;
  input.mesh = std::move(read.mesh);
  input.remarks = std::move(read.remarks);
  if (!with_faces) input.mesh.triangles.clear();
  return true;
}

/// Into the environment's unit, where the file's is known.
void scale(ModelInput& input, const ModelOptions& options) {
  const double unit = options.unit > 0 ? options.unit : input.declared_unit;
  if (unit == 0 || unit == options.environment_unit) return;
  const UnitFactor scaled(unit, options.environment_unit);
  for (Vec3& p : input.mesh.vertices) {
    const Vec3 place{scaled(p.x), scaled(p.y), scaled(p.z)};
    if (!std::isfinite(place.x) || !std::isfinite(place.y) || !std::isfinite(place.z)) {
      refuse(input.path.string(), "(" + shown(p.x) + ", " + shown(p.y) + ", " + shown(p.z) +
                                      ") is too large in the environment's unit; expected finite "
                                      "coordinates");
    }
    p = place;
  }
  input.remarks.largest_bend *= scaled.factor();
  if (options.unit > 0) return;
  tell(input.messages, input,
       "its unit is " + shown(unit) + " m, the environment's " + shown(options.environment_unit) +
           " m: its coordinates are converted",
       {{"metres", unit}});
}

/// Of a mesh and of vertices that stand alone in a mesh's file.
void tell_remarks(ModelInput& input) {
  const MeshRemarks& remarks = input.remarks;
  if (remarks.last_line_open) {
    tell(input.messages, input,
         "the last line has no line break; make sure that the file is whole");
  }
  if (remarks.not_faces > 0) {
    tell(input.messages, input,
         format_count(remarks.not_faces) + " lines and points are not read: they are no surface");
  }
  if (remarks.crossing > 0) {
    tell(input.messages, input,
         format_count(remarks.crossing) + " faces have an outline that crosses itself, the first " +
             remarks.first_crossing + "; what they mean is not certain",
         {{"faces", static_cast<double>(remarks.crossing)}}, "mesh-crossing-faces");
  }
}

std::uint64_t unused_vertices(const TriangleMesh& mesh) {
  std::vector<bool> used(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) used[corner] = true;
  }
  std::uint64_t unused = 0;
  for (const bool one : used) unused += one ? 0 : 1;
  return unused;
}

std::vector<Vec3> sampled(const ModelInput& input, double spacing, std::vector<Message>& messages) {
  if (spacing == 0) {
    refuse(input.path.string(),
           "a mesh of " + counted(input.mesh.triangles.size(), "triangle") +
               "; expected a spacing for the points of its surface",
           Remedy::kModelSpacing, 0);
  }
  std::vector<Vec3> points = sample_mesh(input.mesh, spacing, input.path.string());
  const std::uint64_t unused = unused_vertices(input.mesh);
  if (unused > 0) {
    tell(messages, input,
         format_count(unused) + " vertices belong to no face, and are left out of the model");
  }
  tell_bend(input, spacing, "the spacing", messages);
  tell(messages, input,
       "a mesh of " + counted(input.mesh.triangles.size(), "triangle") + ", sampled to " +
           format_count(points.size()) + " points; no place of its surface is farther than " +
           format_number(spacing) + " m from one",
       {{"triangles", static_cast<double>(input.mesh.triangles.size())},
        {"points", static_cast<double>(points.size())},
        {"spacing", spacing}});
  return points;
}

void leave_out_below(const ModelInput& input, double above, std::vector<Vec3>& points,
                     std::vector<Message>& messages) {
  const std::size_t all = points.size();
  if (!std::isfinite(above)) {
    throw UsageError(input.path.string() + ": " + shown(above) +
                     " m as the lowest height of the model; expected a finite number");
  }
  const double highest = std::ranges::max_element(points, {}, [](const Vec3& p) { return p.z; })->z;
  std::erase_if(points, [above](const Vec3& p) { return p.z < above; });
  if (points.empty()) {
    refuse(input.path.string(), "all " + format_count(all) +
                                    " points of the model are below z = " + format_number(above) +
                                    " m, the highest at " + format_number(highest) +
                                    " m; expected one at least that is not left out");
  }
  const std::size_t left_out = all - points.size();
  tell(messages, input,
       format_count(left_out) + " of " + format_count(all) +
           " model points are below z = " + format_number(above) + " m, and are left out",
       {{"left_out", static_cast<double>(left_out)}, {"above", above}});
}

}  // namespace

void tell_bend(const ModelInput& input, double allowed, const std::string& of_what,
               std::vector<Message>& messages) {
  const double bend = input.remarks.largest_bend;
  if (!(bend > kBendToTell * allowed)) return;
  const std::string text = "a face with more than three corners is bent by " + format_brief(bend) +
                           " m (" + input.remarks.largest_bend_at +
                           "); how it is cut into triangles changes the surface by about as much";
  if (bend <= allowed) return tell(messages, input, text);
  tell(messages, input, text + ", which is more than " + of_what + ". Export the mesh as triangles",
       {{"bend", bend}, {"spacing", allowed}}, "mesh-bent-faces");
}

ModelInput read_model_input(const std::filesystem::path& path, const ModelOptions& options) {
  if (!(options.unit >= 0) || !(options.environment_unit > 0)) {
    throw UsageError(path.string() + ": units of " + shown(options.unit) + " m and " +
                     shown(options.environment_unit) + " m; expected numbers above 0");
  }
  const bool with_faces = !options.vertices_only;
  ModelInput input;
  input.path = path;
  const bool mesh = read_as_mesh(input, with_faces);
  if (!mesh) read_points(input);
  if (input.mesh.vertices.empty()) {
    refuse(path.string(), "the model has no points; expected one at least");
  }
  scale(input, options);
  tell_remarks(input);
  if (mesh && !input.is_mesh()) {
    tell(input.messages, input,
         std::string(with_faces ? "has no faces: " : "faces are left out: ") +
             "the model is its vertices, " + format_count(input.mesh.vertices.size()));
  }
  return input;
}

std::vector<Vec3> points_of(const ModelInput& input, const ModelOptions& options,
                            std::vector<Message>& messages) {
  messages.insert(messages.end(), input.messages.begin(), input.messages.end());
  const bool as_surface = input.is_mesh() && !options.vertices_only;
  std::vector<Vec3> points =
      as_surface ? sampled(input, options.spacing, messages) : input.mesh.vertices;
  if (options.above) leave_out_below(input, *options.above, points, messages);
  return points;
}

}  // namespace clearway
