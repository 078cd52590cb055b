#include "cli/support/program_json.hpp"

#include "io/files/xxh64.hpp"

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

nlohmann::ordered_json sources_json(const StoreMetadata& store) {
  auto out = nlohmann::ordered_json::array();
  std::uint64_t first = 0;
  for (std::size_t i = 0; i < store.sources.size(); ++i) {
    const SourceFile& source = store.sources[i];
    nlohmann::ordered_json one{{"name", source.name},
                               {"bytes", source.bytes},
                               {"xxh64", hash_text(source.xxh64)},
                               {"first_source", nullptr},
                               {"points", nullptr}};
    const auto points = store.points_of_source(i);
    if (points) {
      one["first_source"] = first;
      one["points"] = *points;
      first += *points;
    }
    out.push_back(std::move(one));
  }
  return out;
}

nlohmann::ordered_json origins_json(const StoreOrigins& origins) {
  auto rest_on = nlohmann::ordered_json::array();
  for (const OriginBasis& basis : origins.rest_on) {
    rest_on.push_back({{"what", basis.what}, {"points", basis.points}});
  }
  return {{"distinct", origins.quanta.size()},
          {"points_without", origins.points_without},
          {"rest_on", rest_on},
          {"hash", hash_text(origins.hash)}};
}

nlohmann::ordered_json warnings_json(const std::vector<Message>& warnings) {
  auto out = nlohmann::ordered_json::array();
  for (const Message& warning : warnings) {
    auto numbers = nlohmann::ordered_json::object();
    for (const auto& [name, value] : warning.numbers) numbers[name] = value;
    out.push_back({{"code", warning.code}, {"message", warning.text}, {"numbers", numbers}});
    if (warning.stretches.empty()) continue;
    auto& stretches = out.back()["stretches"] = nlohmann::ordered_json::array();
    for (const PoseRange& stretch : warning.stretches) {
      stretches.push_back({stretch.first, stretch.last});
    }
  }
  return out;
}

}  // namespace clearway::tool
