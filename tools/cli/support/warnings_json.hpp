#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "clearway/progress.hpp"

namespace clearway::tool {

/// The `warnings` of a command's JSON: an array of {"code", "message", "numbers": {name: value}}.
/// A number that is not finite becomes null.
nlohmann::ordered_json warnings_json(const std::vector<Message>& warnings);

}  // namespace clearway::tool
