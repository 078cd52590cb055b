#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/box.hpp"

namespace clearway::tool {

/// The classes of lists such as "2,7" and "3-5", ascending, each once. Throws CLI::ValidationError.
std::vector<std::uint8_t> parse_classes(const std::vector<std::string>& lists);

/// The box of "x0,y0,z0,x1,y1,z1". Throws CLI::ValidationError.
Box parse_box(const std::string& text);

/// The ignored points of an answer, with the keys points, colliding (null where it is not known),
/// classes and boxes.
nlohmann::ordered_json ignored_json(const Answer& answer);

}  // namespace clearway::tool
