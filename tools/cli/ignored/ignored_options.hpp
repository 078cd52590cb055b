#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/box.hpp"

namespace clearway::tool {

/// Of lists as "2,7" and "3-5", ascending, each once. Throws CLI::ValidationError.
std::vector<std::uint8_t> parse_classes(const std::vector<std::string>& lists);

/// Of "x0,y0,z0,x1,y1,z1". Throws CLI::ValidationError.
Box parse_box(const std::string& text);

/// Keys points, colliding (null where it is not known), classes and boxes.
nlohmann::ordered_json ignored_json(const Answer& answer);

}  // namespace clearway::tool
