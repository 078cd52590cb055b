#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace clearway::tool {

/// The object that every report in JSON begins with: "version", of the program, and "files".
nlohmann::ordered_json program_json(
    std::initializer_list<std::pair<const char*, std::filesystem::path>> files);

/// The text of one JSON object, in which bytes of names that are no UTF-8 are replaced.
std::string text_of_json(const nlohmann::ordered_json& object);

}  // namespace clearway::tool
