#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

namespace clearway {

/// Thrown by parse_json(): what is wrong with the text, and where. The file is not named.
class JsonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How deep lists and objects may be nested. Whatever copies, writes or compares a value calls
/// itself once for each level, so that text from outside must not choose how deep that goes.
inline constexpr std::size_t kMostJsonNesting = 64;

/// Reads a JSON text in time that is linear in its length. Refuses one that is nested deeper than
/// kMostJsonNesting, and a key that stands twice in one object, because a reader would silently
/// take one of the two. Throws JsonError.
nlohmann::ordered_json parse_json(std::string_view text);

}  // namespace clearway
