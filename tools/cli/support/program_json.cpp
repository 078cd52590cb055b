#include "cli/support/program_json.hpp"

#include "io/files/xxh64.hpp"

namespace clearway::tool {

Json program_json(std::initializer_list<std::pair<const char*, std::filesystem::path>> files) {
  Json out{{"version", CLEARWAY_VERSION}, {"files", Json::object()}};
  for (const auto& [role, path] : files) out["files"][role] = path.string();
  return out;
}

Json sources_json(const StoreMetadata& store) {
  auto out = Json::array();
  std::uint64_t first = 0;
  for (std::size_t i = 0; i < store.sources.size(); ++i) {
    const SourceFile& source = store.sources[i];
    Json one{{"name", source.name},
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

Json corridor_json(const StoreCorridor& near) {
  return {{"within", near.within},
          {"path_poses", near.path.size()},
          {"points_left_out", near.left_out},
          {"points_unread", near.unread},
          {"bytes_unread", near.unread_bytes},
          {"files_passed_over", near.passed_over},
          {"whole", near.whole}};
}

Json origins_json(const StoreOrigins& origins) {
  auto rest_on = Json::array();
  for (const OriginBasis& basis : origins.rest_on) {
    rest_on.push_back({{"what", basis.what}, {"points", basis.points}});
  }
  return {{"distinct", origins.quanta.size()},
          {"points_without", origins.points_without},
          {"rest_on", rest_on},
          {"hash", hash_text(origins.hash)}};
}

}  // namespace clearway::tool
