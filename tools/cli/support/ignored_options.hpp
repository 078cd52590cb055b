#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/box.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace clearway::tool {

/// Adds an option for lists of classes such as "2,7" and "3-5", which become ascending, each class
/// once. `classes` outlive the command.
CLI::Option* add_class_option(CLI::App& command, const std::string& name,
                              std::vector<std::uint8_t>& classes, const std::string& help);

/// Adds an option for a box "x0,y0,z0,x1,y1,z1", which may be given several times. `boxes` outlive
/// the command.
CLI::Option* add_box_option(CLI::App& command, const std::string& name, std::vector<Box>& boxes,
                            const std::string& help);

/// The ignored points of an answer, with the keys points, colliding (null where it is not known),
/// classes and boxes.
nlohmann::ordered_json ignored_json(const Answer& answer);

}  // namespace clearway::tool
