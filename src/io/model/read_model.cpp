#include "clearway/model.hpp"
#include "io/model/model_input.hpp"

namespace clearway {

std::vector<Vec3> read_model(const std::filesystem::path& path, const ModelOptions& options,
                             std::vector<Message>* messages) {
  const ModelInput input = read_model_input(path, options);
  std::vector<Message> told;
  std::vector<Vec3> points = points_of(input, options, told);
  if (messages) messages->insert(messages->end(), told.begin(), told.end());
  return points;
}

std::vector<Vec3> read_model(const std::filesystem::path& path, std::vector<Message>* messages) {
  return read_model(path, ModelOptions{}, messages);
}

}  // namespace clearway
