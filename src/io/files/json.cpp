#include "io/files/json.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/util/format.hpp"
#include "io/files/input_error.hpp"

namespace clearway {
namespace {

using nlohmann::ordered_json;

/// Throws for JSON that is nested too deeply, before anything is built from it.
void check_nesting(std::string_view text) {
  std::size_t depth = 0, line = 1, line_begin = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') {
      ++line;
      line_begin = i + 1;
    }
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMostJsonNesting) {
        throw JsonError("line " + std::to_string(line) + ", column " +
                        std::to_string(i - line_begin + 1) +
                        ": lists and objects are nested too deep, expected at most " +
                        std::to_string(kMostJsonNesting) + " levels");
      }
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
}

/// What is wrong with a JSON file, worded for the people who wrote it. what: the library's own
/// description.
std::string in_plain_words(const std::string& what) {
  const auto has = [&](const char* part) { return what.find(part) != std::string::npos; };
  const std::string place = what.substr(0, what.find(": ") + 2);  // "parse error at line 3, ...: "
  std::string last;
  if (const auto begin = what.find("; last read: "); begin != std::string::npos) {
    last = what.substr(begin + 2, what.find("'; ", begin) - begin - 1);
  }
  if (has("ill-formed UTF-8") || !has("syntax error")) return what;
  if (has("unexpected end of input")) {
    return place + "the text ends too early; a bracket, a brace or a quote is not closed";
  }
  if (has("missing closing quote")) return place + "a text in quotes has no closing quote";
  if (has("invalid literal")) {
    return place + "a word that is not JSON; texts and names stand in double quotes (" + last + ")";
  }
  if (has("object key - unexpected '}'")) return place + "a comma too many, before '}'";
  if (has("parsing value - unexpected ']'")) {
    return place + "a comma too many or a value too few, before ']'";
  }
  if (has("parsing value - unexpected '}'")) return place + "a value is missing before '}'";
  if (has("parsing object key")) return place + "a name in double quotes is expected here";
  if (has("parsing object separator")) return place + "a colon is missing after the name";
  if (has("parsing object - unexpected")) return place + "a comma or '}' is missing before this";
  if (has("parsing array - unexpected")) return place + "a comma or ']' is missing before this";
  return what;
}

/// Builds the value in linear time. The library's own builder compares each new key with all
/// earlier ones, and with a callback also visits all earlier elements of a list at each new one.
class ValueBuilder : public nlohmann::json_sax<ordered_json> {
 public:
  ordered_json take() { return std::move(root_); }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t& value) override { return add(std::move(value)); }
  bool start_object(std::size_t) override { return open(ordered_json::object()); }
  bool start_array(std::size_t) override { return open(ordered_json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    Open& object = open_.back();
    object.key = name;
    if (!object.seen.insert(name).second) throw JsonError(place() + ": stands twice");
    return true;
  }

  bool parse_error(std::size_t, const std::string&,
                   const nlohmann::detail::exception& error) override {
    // The message repeats the token, which may be a long string.
    constexpr std::size_t kMostBytes = 300;
    std::string what = error.what();  // "[json.exception...] parse error at line 3, column 5: ..."
    const std::size_t begin = what.find("] ");
    if (begin != std::string::npos) what.erase(0, begin + 2);
    what = in_plain_words(what);
    if (what.size() > kMostBytes) what = what.substr(0, kMostBytes) + " ...";
    throw JsonError("is no JSON: " + what);
  }

 private:
  /// An object or list whose end has not been read. Until then nothing is added to the value that
  /// contains it, so the pointer stays valid.
  struct Open {
    ordered_json* value;
    std::set<std::string> seen{};
    std::string key{};
  };

  ordered_json& append(ordered_json&& value) {
    if (open_.empty()) return root_ = std::move(value);
    Open& within = open_.back();
    if (within.value->is_array()) {
      auto& list = within.value->get_ref<ordered_json::array_t&>();
      return list.emplace_back(std::move(value));
    }
    auto& object = within.value->get_ref<ordered_json::object_t&>();
    return object.emplace_back(within.key, std::move(value)).second;
  }
  bool add(ordered_json&& value) {
    append(std::move(value));
    return true;
  }
  bool open(ordered_json&& value) {
    open_.push_back({&append(std::move(value))});
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  /// The key of the current value, as in "bodies[1].name".
  std::string place() const {
    std::string text;
    for (const Open& within : open_) {
      if (within.value->is_array()) {
        text += "[" + std::to_string(within.value->size() - 1) + "]";
      } else {
        text += (text.empty() ? "" : ".") + within.key;
      }
    }
    return text;
  }

  ordered_json root_;
  std::vector<Open> open_;
};

}  // namespace

ordered_json parse_json(std::string_view text) {
  check_nesting(text);
  ValueBuilder builder;
  ordered_json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take();
}

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
