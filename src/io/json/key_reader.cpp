#include "io/json/key_reader.hpp"

#include <algorithm>
#include <set>

#include "io/system/input_error.hpp"

namespace clearway {
namespace {

using nlohmann::ordered_json;

/// Watches the parser for keys that stand twice.
class KeyWatch {
 public:
  explicit KeyWatch(const std::string& file) : file_(file) {}

  bool operator()(int, ordered_json::parse_event_t event, const ordered_json& parsed) {
    using Event = ordered_json::parse_event_t;
    if (event == Event::object_start) open_.emplace_back();
    if (event == Event::object_end) open_.pop_back();
    if (event == Event::key) add(parsed.get<std::string>());
    return true;
  }

 private:
  struct Open {
    std::set<std::string> seen;
    std::string last;
  };

  void add(const std::string& name) {
    open_.back().last = name;
    if (open_.back().seen.insert(name).second) return;
    std::string key;
    for (const Open& object : open_) key += (key.empty() ? "" : ".") + object.last;
    clearway::refuse(file_, key + ": stands twice");
  }

  const std::string& file_;
  std::vector<Open> open_;
};

std::string list_of(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

}  // namespace

KeyReader KeyReader::parse(const std::filesystem::path& file, const std::string& text) {
  try {
    KeyWatch watch(file.string());
    ordered_json value = ordered_json::parse(text, std::ref(watch));
    if (!value.is_object()) clearway::refuse(file.string(), "expected one JSON object");
    return {file.string(), "", "", std::move(value)};
  } catch (const ordered_json::exception& error) {
    std::string what = error.what();  // "[json.exception...] parse error at line 3, column 5: ..."
    const std::size_t begin = what.find("] ");
    if (begin != std::string::npos) what.erase(0, begin + 2);
    clearway::refuse(file.string(), "is no JSON: " + what);
  }
}

void KeyReader::allow(const std::vector<std::string>& known) const {
  if (!value_.is_object()) refuse("expected an object with the keys " + list_of(known));
  for (const auto& [name, value] : value_.items()) {
    if (std::ranges::find(known, name) != known.end()) continue;
    below(name, value).refuse("unknown key; expected one of " + list_of(known));
  }
}

KeyReader KeyReader::at(const std::string& name) const {
  if (!has(name)) {
    below(name, nullptr).refuse("is missing");
  }
  return below(name, value_[name]);
}

std::vector<KeyReader> KeyReader::members() const {
  if (!value_.is_object()) refuse("expected an object of names and what they stand for");
  std::vector<KeyReader> out;
  for (const auto& [name, value] : value_.items()) out.push_back(below(name, value));
  if (out.empty()) refuse("is empty");
  return out;
}

std::vector<KeyReader> KeyReader::elements() const {
  if (!value_.is_array()) refuse("expected a list, in brackets");
  std::vector<KeyReader> out;
  for (const auto& value : value_) {
    const std::string number = std::to_string(out.size());
    out.push_back({file_, key_ + "[" + number + "]", number, value});
  }
  if (out.empty()) refuse("is empty");
  return out;
}

std::string KeyReader::text() const {
  if (!value_.is_string()) refuse("expected a text, in quotes");
  auto text = value_.get<std::string>();
  if (text.empty()) refuse("is empty");
  return text;
}

bool KeyReader::flag() const {
  if (!value_.is_boolean()) refuse("expected true or false");
  return value_.get<bool>();
}

void KeyReader::refuse(const std::string& what) const {
  clearway::refuse(file_, key_.empty() ? what : key_ + ": " + what);
}

KeyReader KeyReader::below(const std::string& name, const ordered_json& value) const {
  return {file_, key_.empty() ? name : key_ + "." + name, name, value};
}

}  // namespace clearway
