#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace clearway::tool {

/// What clearway model prints of a model's file as JSON: its size, its parts, and whether they are
/// closed. Throws InputError as read_model() does.
nlohmann::ordered_json description_of_model(const std::filesystem::path& file);

}  // namespace clearway::tool
