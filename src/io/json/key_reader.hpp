#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace clearway {

/// A value of a JSON file that people write, and its key, as "vehicles.truck.model". Every
/// complaint throws InputError "FILE: KEY: what".
class KeyReader {
 public:
  /// The whole file. A key that stands twice in one object is refused, as a reader would take the
  /// last one silently.
  static KeyReader parse(const std::filesystem::path& file, const std::string& text);

  const std::string& key() const { return key_; }
  const nlohmann::ordered_json& value() const { return value_; }

  /// Of an object. Refuses keys that are not among them.
  void allow(const std::vector<std::string>& known) const;
  bool has(const std::string& name) const { return value_.is_object() && value_.contains(name); }
  /// Refuses an object that does not have it.
  KeyReader at(const std::string& name) const;
  /// The values of an object, or of an array, in the order of the file; refuses what is neither.
  std::vector<KeyReader> members() const;
  std::vector<KeyReader> elements() const;
  /// Last part of the key.
  const std::string& name() const { return name_; }

  std::string text() const;  ///< of a string that is not empty
  bool flag() const;

  [[noreturn]] void refuse(const std::string& what) const;

 private:
  KeyReader(std::string file, std::string key, std::string name, nlohmann::ordered_json value)
      : file_(std::move(file)),
        key_(std::move(key)),
        name_(std::move(name)),
        value_(std::move(value)) {}
  KeyReader below(const std::string& name, const nlohmann::ordered_json& value) const;

  std::string file_, key_, name_;
  nlohmann::ordered_json value_;
};

}  // namespace clearway
