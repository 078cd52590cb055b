#include "clearway/model.hpp"
#include "io/model/model_input.hpp"
#include "io/model/surface_of.hpp"

namespace clearway {

std::vector<Vec3> read_model(const std::filesystem::path& path, const ModelOptions& options,
                             std::vector<Message>* messages) {
  const ModelInput input = read_model_input(path, options);
  std::vector<Message> told;
  std::vector<Vec3> points = points_of(input, options, told);
  if (messages) messages->insert(messages->end(), told.begin(), told.end());
  return points;
}

ModelShape read_model_shape(const std::filesystem::path& path, const ModelOptions& options,
                            std::vector<Message>* messages) {
  const ModelInput input = read_model_input(path, options);
  std::vector<Message> told;
  ModelShape shape;
  const bool as_surface =
      options.as == ModelAs::kSurface || (options.as == ModelAs::kSurfaceOfMesh && input.is_mesh());
  if (as_surface) {
    TriangleMesh surface = surface_of(input, options, told);
    shape = {std::move(surface.vertices), std::move(surface.triangles)};
  } else {
    shape.points = points_of(input, options, told);
  }
  if (messages) messages->insert(messages->end(), told.begin(), told.end());
  return shape;
}

std::vector<Vec3> read_model(const std::filesystem::path& path, std::vector<Message>* messages) {
  return read_model(path, ModelOptions{}, messages);
}

}  // namespace clearway
