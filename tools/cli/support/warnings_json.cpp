#include "cli/support/warnings_json.hpp"

namespace clearway::tool {

nlohmann::ordered_json warnings_json(const std::vector<Message>& warnings) {
  auto out = nlohmann::ordered_json::array();
  for (const Message& warning : warnings) {
    auto numbers = nlohmann::ordered_json::object();
    for (const auto& [name, value] : warning.numbers) numbers[name] = value;
    out.push_back({{"code", warning.code}, {"message", warning.text}, {"numbers", numbers}});
  }
  return out;
}

}  // namespace clearway::tool
