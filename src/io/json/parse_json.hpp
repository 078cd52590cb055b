#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

namespace clearway {

/// Thrown by parse_json(). It says what is wrong with the text and where, but does not name the
/// file.
class JsonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Deepest nesting of lists and objects. Code that copies, writes or compares a value recurses once
/// per level, so a text from outside must not choose the depth.
inline constexpr std::size_t kMostJsonNesting = 64;

/// Parses a JSON text in linear time. Refuses one that is nested deeper than kMostJsonNesting, and
/// a key that occurs twice in one object, because a reader would silently take one of the two.
/// Throws JsonError.
nlohmann::ordered_json parse_json(std::string_view text);

}  // namespace clearway
