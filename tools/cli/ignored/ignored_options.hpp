#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/ignored.hpp"
#include "clearway/query.hpp"

namespace clearway::tool {

/// Of lists as "2,7" and "3-5", ascending, each once. Throws CLI::ValidationError.
std::vector<std::uint8_t> parse_classes(const std::vector<std::string>& lists);

/// Of "x0,y0,z0,x1,y1,z1". Throws CLI::ValidationError.
Box parse_box(const std::string& text);

/// Keys points, classes and boxes. counts: of the query's lists, as the result has them.
nlohmann::ordered_json ignored_json(const QueryParameters& query, const IgnoredPointCounts& counts);

}  // namespace clearway::tool
