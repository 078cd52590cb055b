#include "cli/support/sources_json.hpp"

#include "io/system/xxh64.hpp"

namespace clearway::tool {

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

}  // namespace clearway::tool
