#include "clearway/error.hpp"
#include "clearway/model.hpp"
#include "io/model/mesh_parts.hpp"
#include "io/model/model_input.hpp"
#include "io/model/surface_of.hpp"

namespace clearway {
namespace {

Model solids_of(const ModelInput& input, const ModelOptions& options, std::vector<Message>& told) {
  if (options.above) {
    throw UsageError(input.path.string() +
                     ": cut at a height, parts of the model are open and no longer solid; search "
                     "its surface, or take a file without what is to be left out");
  }
  MeshParts parts = parts_with_solids(surface_of(input, options, told), input.path.string());
  const auto tell = [&](const std::string& text) {
    told.push_back({Message::Severity::kNote, "", input.path.string() + ": " + text, {}});
  };
  tell(summary_of(parts));
  const std::string faults = faults_of(parts);
  if (!faults.empty()) tell("what keeps parts from being solid: " + faults);
  return {std::move(parts.mesh.vertices), std::move(parts.mesh.triangles),
          std::move(parts.solid_of)};
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
  std::vector<Message> told;
  Model shape;
  switch (resolved_kind(input, options)) {
    case ModelAs::kSolid:
      shape = solids_of(input, options, told);
      break;
    case ModelAs::kSurface: {
      TriangleMesh surface = surface_of(input, options, told);
      shape = {std::move(surface.vertices), std::move(surface.triangles)};
      break;
    }
    default:
      shape = points_of(input, options, told);
  }
  if (messages) messages->insert(messages->end(), told.begin(), told.end());
  return shape;
}

std::vector<Vec3> read_model_points(const std::filesystem::path& path,
                                    std::vector<Message>* messages) {
  return read_model_points(path, ModelOptions{}, messages);
}

}  // namespace clearway
