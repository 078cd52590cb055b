#include "cli/support/program_json.hpp"

namespace clearway::tool {

nlohmann::ordered_json program_json(
    std::initializer_list<std::pair<const char*, std::filesystem::path>> files) {
  nlohmann::ordered_json out{{"version", CLEARWAY_VERSION},
                             {"files", nlohmann::ordered_json::object()}};
  for (const auto& [role, path] : files) out["files"][role] = path.string();
  return out;
}

std::string text_of_json(const nlohmann::ordered_json& object) {
  return object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace clearway::tool
