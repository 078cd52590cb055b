#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

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
