#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "clearway/progress.hpp"
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

/// A field's value as a cell of a CSV file, empty where it is absent.
std::string csv_value(const FieldValue& value);

/// A vector as JSON: [x, y, z].
std::string json_vector(const Vec3& v);

/// Fields as a JSON object. The three fields of a vector's coordinates become one, an array.
std::string json_object(const std::vector<ConflictField>& fields);

/// Texts as a JSON array of strings.
std::string json_strings(const std::vector<std::string>& texts);

/// Messages as a JSON array of objects with code, message and numbers.
std::string json_messages(const std::vector<Message>& messages);

/// The members of a JSON object, without its braces, each on a line that begins with two blanks.
class JsonMembers {
 public:
  /// json: the value as JSON.
  void add(std::string_view name, const std::string& json);
  void add_count(std::string_view name, std::uint64_t count) { add(name, std::to_string(count)); }
  void add_length(std::string_view name, double length) { add(name, json_number(length)); }
  /// Adds a hash as a string of hexadecimal digits.
  void add_hash(std::string_view name, std::uint64_t hash);
  std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace clearway
