#pragma once

#include <string>
#include <string_view>

#include "clearway/vec3.hpp"
#include "io/result/conflicts/conflict_fields.hpp"

namespace clearway {

/// The text as valid UTF-8. Bytes that are not UTF-8 become U+FFFD.
std::string valid_utf8(std::string_view text);

/// The text as a JSON string, including quotes. Bytes that are not UTF-8 become U+FFFD.
std::string json_string(std::string_view text);

/// A number with the fewest digits that give it back; null where it is not finite.
std::string json_number(double value);

/// A field's value as JSON: null, a number or a string.
std::string json_value(const FieldValue& value);

/// A vector as JSON: [x, y, z].
std::string json_vector(const Vec3& v);

}  // namespace clearway
