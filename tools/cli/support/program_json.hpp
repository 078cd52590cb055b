#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "clearway/progress.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway::tool {

/// The object that every report in JSON begins with: "version", of the program, and "files".
nlohmann::ordered_json program_json(
    std::initializer_list<std::pair<const char*, std::filesystem::path>> files);

/// The text of one JSON object, in which bytes of names that are no UTF-8 are replaced.
std::string text_of_json(const nlohmann::ordered_json& object);

/// The files that a store was made of: "name", "bytes", "xxh64", and "first_source" and "points",
/// which say which source indices are theirs and are null where the store does not tell.
nlohmann::ordered_json sources_json(const StoreMetadata& store);
/// The origins of a store: how many are distinct, what they rest on, and how many points have none.
nlohmann::ordered_json origins_json(const StoreOrigins& origins);

/// The `warnings` of a command's JSON: an array of {"code", "message", "numbers": {name: value}}.
/// A number that is not finite becomes null.
nlohmann::ordered_json warnings_json(const std::vector<Message>& warnings);

}  // namespace clearway::tool
