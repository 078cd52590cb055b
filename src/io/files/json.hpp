#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// A value of JSON whose objects keep the order of their members.
using Json = nlohmann::ordered_json;

void to_json(Json& json, const Vec3& v);           ///< [x, y, z]
void to_json(Json& json, const Box& box);          ///< {"lo", "hi"}
void to_json(Json& json, const PoseRange& range);  ///< [first, last]
/// {"code", "message", "numbers"} and, where it has any, "stretches"
void to_json(Json& json, const Message& message);

/// The value, or null.
template <typename Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

/// The text of a value as programs print it and keep it, and a line break. indent: the blanks of
/// each level; -1 for all on one line. Like all texts below, it has U+FFFD instead of bytes that
/// are not UTF-8.
std::string indented_text(const Json& json, int indent = 2);
/// The text of a value without blanks, in which "<" is escaped, so that it may stand in a page.
std::string page_text(const Json& json);
/// The text of a value on one line of a file.
std::string line_text(const Json& json);
/// The members of an object without its braces, each on a line that begins with two blanks.
std::string member_lines(const Json& object);

/// The text as valid UTF-8. Bytes that are not UTF-8 become U+FFFD.
std::string valid_utf8(std::string_view text);
/// The text as a JSON string, including quotes.
std::string json_string(std::string_view text);
/// A number with the fewest digits that give it back; null where it is not finite.
std::string json_number(double value);

/// Thrown by parse_json(). It says what is wrong with the text and where, but does not name the
/// file.
class JsonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Deepest nesting of lists and objects. Code that copies, writes or compares a value recurses once
/// per level, so a file from outside must not choose the depth.
inline constexpr std::size_t kMostJsonNesting = 64;

/// Parses a JSON text in linear time. Refuses one that is nested deeper than kMostJsonNesting, and
/// a key that occurs twice in one object, because a reader would silently take one of the two.
/// Throws JsonError.
nlohmann::ordered_json parse_json(std::string_view text);

/// A value of a JSON file that people write, with its key, as in "vehicles.truck.model". Every
/// error throws InputError "FILE: KEY: what".
class KeyReader {
 public:
  /// Parses the whole file. Throws for what parse_json() refuses.
  static KeyReader parse(const std::filesystem::path& file, const std::string& text);

  const std::string& key() const { return key_; }
  const nlohmann::ordered_json& value() const { return *value_; }

  /// Throws unless the value is an object whose keys are all among `known`.
  void allow(const std::vector<std::string>& known) const;
  bool has(const std::string& name) const { return value().is_object() && value().contains(name); }
  /// The member of an object. Throws where the object lacks it.
  KeyReader at(const std::string& name) const;
  /// The values of an object in the order of the file. Throws for other values and for an empty
  /// object.
  std::vector<KeyReader> members() const;
  /// The values of a list in the order of the file. Throws for other values, for an empty list, and
  /// for one of more than `most` entries.
  std::vector<KeyReader> elements(std::size_t most = std::numeric_limits<std::size_t>::max()) const;
  /// The last part of the key.
  const std::string& name() const { return name_; }

  std::string text() const;  ///< a string that is not empty
  bool flag() const;

  [[noreturn]] void refuse(const std::string& what) const;

 private:
  using Document = std::shared_ptr<const nlohmann::ordered_json>;

  KeyReader(std::string file, std::string key, std::string name, Document document,
            const nlohmann::ordered_json& value)
      : file_(std::move(file)),
        key_(std::move(key)),
        name_(std::move(name)),
        document_(std::move(document)),
        value_(&value) {}
  KeyReader below(const std::string& name, const nlohmann::ordered_json& value) const;

  std::string file_, key_, name_;
  Document document_;                    ///< the whole file, which all its readers share
  const nlohmann::ordered_json* value_;  ///< the value within document_
};

}  // namespace clearway
