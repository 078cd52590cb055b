#pragma once

#include <string>
#include <string_view>

#include "clearway/vec3.hpp"
#include "io/conflicts/conflict_fields.hpp"

namespace clearway {

/// Bytes that are not UTF-8 become U+FFFD.
std::string valid_utf8(std::string_view text);

/// A string of JSON, quotes included. Bytes that are not UTF-8 become U+FFFD.
std::string json_string(std::string_view text);

/// The shortest digits that give the number back; null where it is not finite.
std::string json_number(double value);

/// Null, a number or a string.
std::string json_value(const FieldValue& value);

/// [x, y, z]
std::string json_vector(const Vec3& v);

}  // namespace clearway
