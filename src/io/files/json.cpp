#include "io/files/json.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/util/format.hpp"
#include "core/util/shortened.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_lines.hpp"

namespace clearway {
namespace {

/// Number of bytes of the UTF-8 character at the start of the text; 0 where there is none. Source:
/// RFC 3629.
std::size_t character_bytes(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const auto follows = [&](std::size_t i, unsigned lo = 0x80, unsigned hi = 0xbf) {
    return i < text.size() && byte(i) >= lo && byte(i) <= hi;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf) return follows(1) ? 2 : 0;
  if (first >= 0xe0 && first <= 0xef) {
    const bool second = follows(1, first == 0xe0 ? 0xa0 : 0x80, first == 0xed ? 0x9f : 0xbf);
    return second && follows(2) ? 3 : 0;
  }
  if (first >= 0xf0 && first <= 0xf4) {
    const bool second = follows(1, first == 0xf0 ? 0x90 : 0x80, first == 0xf4 ? 0x8f : 0xbf);
    return second && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

void append_escaped(std::string& out, char c) {
  constexpr std::string_view kHex = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(c);
  if (c == '"' || c == '\\') {
    out += {'\\', c};
  } else if (byte < 0x20 || byte == 0x7f) {
    out += {'\\', 'u', '0', '0', kHex[byte >> 4], kHex[byte & 15]};
  } else {
    out += c;
  }
}

/// How the text of a value is made.
struct JsonStyle {
  const char *between_values, *after_key;
  std::string (*number)(double);
  bool escapes_tags;
};

/// 1e+05 for 100000, because it is shorter.
constexpr JsonStyle kLine{", ", ": ", json_number, false};
constexpr JsonStyle kPage{
    ",", ":", [](double number) { return std::isfinite(number) ? format_number(number) : "null"; },
    true};

void append_string(std::string& out, std::string_view text, const JsonStyle& style) {
  for (const char c : json_string(text)) {
    if (c == '<' && style.escapes_tags) {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
}

void append_value(std::string& out, const Json& json, const JsonStyle& style) {
  const char* between = "";
  const auto next = [&] {
    out += between;
    between = style.between_values;
  };
  switch (json.type()) {
    case Json::value_t::object:
      out += '{';
      for (const auto& [key, value] : json.items()) {
        next();
        append_string(out, key, style);
        out += style.after_key;
        append_value(out, value, style);
      }
      out += '}';
      return;
    case Json::value_t::array:
      out += '[';
      for (const Json& value : json) {
        next();
        append_value(out, value, style);
      }
      out += ']';
      return;
    case Json::value_t::string:
      return append_string(out, json.get_ref<const std::string&>(), style);
    case Json::value_t::number_float:
      out += style.number(json.get<double>());
      return;
    default:
      out += json.dump();
  }
}

std::string text_of(const Json& json, const JsonStyle& style) {
  std::string out;
  append_value(out, json, style);
  return out;
}

}  // namespace

std::string valid_utf8(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t bytes = character_bytes(text);
    out += bytes == 0 ? "\xef\xbf\xbd" : text.substr(0, bytes);
    text.remove_prefix(bytes == 0 ? 1 : bytes);
  }
  return out;
}

void to_json(Json& json, const Vec3& v) { json = Json::array({v.x, v.y, v.z}); }

void to_json(Json& json, const Box& box) { json = {{"lo", box.lo}, {"hi", box.hi}}; }

void to_json(Json& json, const PoseRange& range) { json = Json::array({range.first, range.last}); }

void to_json(Json& json, const Message& message) {
  Json numbers = Json::object();
  for (const auto& [name, value] : message.numbers) numbers[name] = value;
  json = {{"code", message.code}, {"message", message.text}, {"numbers", std::move(numbers)}};
  if (!message.stretches.empty()) json["stretches"] = message.stretches;
}

std::string indented_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string page_text(const Json& json) { return text_of(json, kPage); }

std::string line_text(const Json& json) { return text_of(json, kLine); }

std::string member_lines(const Json& object) {
  std::string out;
  for (const auto& [key, value] : object.items()) {
    out += (out.empty() ? "  " : ",\n  ") + json_string(key) + ": " + line_text(value);
  }
  return out;
}

std::string json_string(std::string_view text) {
  std::string out = "\"";
  while (!text.empty()) {
    const std::size_t bytes = character_bytes(text);
    if (bytes == 0) {
      out += "\xef\xbf\xbd";
    } else if (bytes == 1) {
      append_escaped(out, text.front());
    } else {
      out += text.substr(0, bytes);
    }
    text.remove_prefix(bytes == 0 ? 1 : bytes);
  }
  return out + "\"";
}

std::string json_number(double value) {
  if (!std::isfinite(value)) return "null";
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

namespace {

using nlohmann::ordered_json;

/// "line 3, column 7", of a byte of a text.
std::string place_in(std::string_view text, std::size_t at) {
  const std::string_view before = text.substr(0, at);
  const std::size_t line_begin = before.find_last_of("\r\n") + 1;
  return "line " + std::to_string(count_line_breaks(before) + 1) + ", column " +
         std::to_string(at - line_begin + 1);
}

/// Throws for JSON that is nested too deeply, before anything is built from it.
void check_nesting(std::string_view text) {
  std::size_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMostJsonNesting) {
        throw JsonError(place_in(text, i) +
                        ": lists and objects are nested too deep, expected at most " +
                        std::to_string(kMostJsonNesting) + " levels");
      }
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
}

/// What is open where the text was refused.
enum class Within { kNothing, kObject, kArray };

/// Says what is wrong with a text that the library refused, from the text itself.
class SyntaxFault {
 public:
  /// read: bytes that the library had read when it refused the text, more than it has at its end.
  SyntaxFault(std::string_view text, std::size_t read)
      : text_(text), at_(std::min(std::max<std::size_t>(read, 1) - 1, text.size())) {
    bool escaped = false;
    for (std::size_t i = 0; i < at_; ++i) {
      if (escaped) {
        escaped = false;
      } else if (in_string_ && text_[i] == '\\') {
        escaped = true;
        escape_ = i;
      } else if (text_[i] == '"') {
        in_string_ = !in_string_;
        if (in_string_) token_ = i;
      }
    }
    closes_string_ = in_string_ && at_ < text_.size() && text_[at_] == '"' && !escaped;
    if (in_string_) {
      end_ = std::min(at_ + 1, text_.size());
    } else {
      find_token();
    }
  }

  /// within: what was open; after_name: whether the last thing that was taken is a name in an
  /// object; is_over: whether the whole value was taken before.
  std::string words(Within within, bool after_name, bool is_over) const {
    return "parse error at " + place_in(text_, at_) + ": " + reason(within, after_name, is_over);
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
  static bool is_mark(char c) { return std::string_view("[]{},:\"").find(c) != std::string::npos; }

  /// The word or number around the place, which the library may have refused in its middle.
  void find_token() {
    const auto belongs = [&](std::size_t i) { return !is_blank(text_[i]) && !is_mark(text_[i]); };
    token_ = at_;
    while (token_ > 0 && belongs(token_ - 1)) --token_;
    end_ = at_;
    while (end_ < text_.size() && belongs(end_)) ++end_;
  }

  std::string reason(Within within, bool after_name, bool is_over) const {
    if (at_ == text_.size()) {
      return "the text ends too early; a bracket, a brace or a quote is not closed";
    }
    if (in_string_ &&
        (!closes_string_ || !ordered_json::accept(text_.substr(token_, end_ - token_)))) {
      return reason_in_string();
    }
    const std::string token(text_.substr(token_, end_ - token_));
    if (!in_string_ && !token.empty() && !ordered_json::accept(token)) {
      const bool number = std::string_view("+-.0123456789").find(token[0]) != std::string::npos;
      return std::string(number
                             ? "a number that JSON does not have, or one that is too large"
                             : "a word that is not JSON; texts and names stand in double quotes") +
             " (" + token + ")";
    }
    return unexpected(within, after_name, is_over);
  }

  std::string reason_in_string() const {
    const auto c = static_cast<unsigned char>(text_[at_]);
    if (c == '\n' || c == '\r') return "a text in quotes has no closing quote on its line";
    if (c < ' ') return "a text in quotes has a control character; expected an escape, as \\t";
    if (c >= 0x80 || static_cast<unsigned char>(text_[at_ - 1]) >= 0x80) {
      return "a text in quotes is not UTF-8";
    }
    return "a text in quotes has an escape that JSON does not have (" +
           std::string(text_.substr(escape_, at_ + 1 - escape_)) +
           "); a backslash is written twice";
  }

  /// About a mark, or a whole value or name, in the wrong place.
  std::string unexpected(Within within, bool after_name, bool is_over) const {
    const char mark = text_[at_];
    std::size_t before = in_string_ || !is_mark(mark) ? token_ : at_;
    while (before > 0 && is_blank(text_[before - 1])) --before;
    const char last = before > 0 ? text_[before - 1] : ' ';
    const std::string named = std::string("'") + mark + "'";
    const bool ends = mark == '}' || mark == ']' || mark == ',' || mark == ':';
    if (is_over) return "the text goes on after its end";
    if (after_name && last != ':') return "a colon is missing after the name";
    if (last == ':') return "a value is missing before " + (ends ? named : "this");
    if (within == Within::kObject && last == ',' && mark == '}') {
      return "a comma too many, before '}'";
    }
    if (last == ',' && mark == ']') return "a comma too many or a value too few, before ']'";
    if (last == ',' || last == '[' || last == '{' || within == Within::kNothing) {
      return within == Within::kObject ? "a name in double quotes is expected here"
                                       : "a value is missing before " + (ends ? named : "this");
    }
    return std::string("a comma or '") + (within == Within::kObject ? '}' : ']') +
           "' is missing before this";
  }

  std::string_view text_;
  std::size_t at_;  ///< byte at which the text was refused
  bool in_string_ = false, closes_string_ = false;
  std::size_t escape_ = 0;           ///< place of the last backslash in a string
  std::size_t token_ = 0, end_ = 0;  ///< the string, word or number there
};

/// Builds the value in linear time. The library's own builder compares each new key with all
/// earlier ones, and with a callback also visits all earlier elements of a list at each new one.
class ValueBuilder : public nlohmann::json_sax<ordered_json> {
 public:
  /// text: what is parsed, for errors. It must outlive this object.
  explicit ValueBuilder(std::string_view text) : text_(text) {}

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
    after_name_ = true;
    if (!object.seen.insert(name).second) throw JsonError(place() + ": stands twice");
    return true;
  }

  bool parse_error(std::size_t read, const std::string&,
                   const nlohmann::detail::exception&) override {
    const Within within = open_.empty()                     ? Within::kNothing
                          : open_.back().value->is_object() ? Within::kObject
                                                            : Within::kArray;
    constexpr std::size_t kMostBytes = 300;  // the text may have a word of any length
    std::string what =
        SyntaxFault(text_, read).words(within, after_name_, open_.empty() && has_begun_);
    what = shortened(what, kMostBytes);
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
    after_name_ = false;
    has_begun_ = true;
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

  std::string_view text_;
  ordered_json root_;
  std::vector<Open> open_;
  bool has_begun_ = false;
  bool after_name_ = false;  ///< whether the last thing that was taken is a name in an object
};

}  // namespace

ordered_json parse_json(std::string_view text) {
  check_nesting(text);
  ValueBuilder builder(text);
  ordered_json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take();
}

namespace {

using nlohmann::ordered_json;

}  // namespace

KeyReader KeyReader::parse(const std::filesystem::path& file, const std::string& text) {
  refuse_foreign(file.string(), text);
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
  if (!value().is_object()) refuse("expected an object with the keys " + with_commas(known));
  for (const auto& [name, value] : value().items()) {
    if (std::ranges::find(known, name) != known.end()) continue;
    below(name, value).refuse("unknown key; expected one of " + with_commas(known));
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
