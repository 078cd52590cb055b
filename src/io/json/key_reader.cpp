#include "io/json/key_reader.hpp"

#include <algorithm>

#include "core/util/format.hpp"
#include "io/json/parse_json.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

using nlohmann::ordered_json;

std::string list_of(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

}  // namespace

KeyReader KeyReader::parse(const std::filesystem::path& file, const std::string& text) {
  try {
    auto document = std::make_shared<const ordered_json>(parse_json(text));
    if (!document->is_object()) clearway::refuse(file.string(), "expected one JSON object");
    const ordered_json& value = *document;
    return {file.string(), "", "", std::move(document), value};
  } catch (const JsonError& error) {
    clearway::refuse(file.string(), error.what());
  }
}

void KeyReader::allow(const std::vector<std::string>& known) const {
  if (!value().is_object()) refuse("expected an object with the keys " + list_of(known));
  for (const auto& [name, value] : value().items()) {
    if (std::ranges::find(known, name) != known.end()) continue;
    below(name, value).refuse("unknown key; expected one of " + list_of(known));
  }
}

KeyReader KeyReader::at(const std::string& name) const {
  static const ordered_json kNothing;
  if (!has(name)) below(name, kNothing).refuse("is missing");
  return below(name, value()[name]);
}

std::vector<KeyReader> KeyReader::members() const {
  if (!value().is_object()) refuse("expected an object of names and what they stand for");
  std::vector<KeyReader> out;
  for (const auto& [name, value] : value().items()) out.push_back(below(name, value));
  if (out.empty()) refuse("is empty");
  return out;
}

std::vector<KeyReader> KeyReader::elements(std::size_t most) const {
  if (!value().is_array()) refuse("expected a list, in brackets");
  if (value().size() > most) {
    refuse("has " + format_count(value().size()) + " entries, expected at most " +
           format_count(most));
  }
  std::vector<KeyReader> out;
  for (const auto& value : value()) {
    const std::string number = std::to_string(out.size());
    out.push_back({file_, key_ + "[" + number + "]", number, document_, value});
  }
  if (out.empty()) refuse("is empty");
  return out;
}

std::string KeyReader::text() const {
  if (!value().is_string()) refuse("expected a text, in quotes");
  auto text = value().get<std::string>();
  if (text.empty()) refuse("is empty");
  return text;
}

bool KeyReader::flag() const {
  if (!value().is_boolean()) refuse("expected true or false");
  return value().get<bool>();
}

void KeyReader::refuse(const std::string& what) const {
  clearway::refuse(file_, key_.empty() ? what : key_ + ": " + what);
}

KeyReader KeyReader::below(const std::string& name, const ordered_json& value) const {
  return {file_, key_.empty() ? name : key_ + "." + name, name, document_, value};
}

}  // namespace clearway
