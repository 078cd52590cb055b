#include "io/result/conflicts/json_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "io/files/text_writer.hpp"
#include "io/files/xxh64.hpp"

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

struct ValueText {
  std::string operator()(std::monostate) const { return "null"; }
  std::string operator()(std::uint64_t number) const { return std::to_string(number); }
  std::string operator()(double number) const { return json_number(number); }
  std::string operator()(std::string_view text) const { return json_string(text); }
};

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

std::string json_value(const FieldValue& value) { return std::visit(ValueText{}, value); }

std::string csv_value(const FieldValue& value) {
  if (std::holds_alternative<std::monostate>(value)) return "";
  const auto* word = std::get_if<std::string_view>(&value);
  return word != nullptr ? csv_cell(*word) : json_value(value);
}

std::string json_vector(const Vec3& v) {
  return "[" + json_number(v.x) + ", " + json_number(v.y) + ", " + json_number(v.z) + "]";
}

std::string json_object(const std::vector<ConflictField>& fields) {
  std::string out;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    std::string name = fields[i].name, value = json_value(fields[i].value);
    if (name.ends_with("_x")) {
      name.resize(name.size() - 2);
      value = "[" + value + ", " + json_value(fields[i + 1].value) + ", " +
              json_value(fields[i + 2].value) + "]";
      i += 2;
    }
    out += (out.empty() ? "" : ", ") + json_string(name) + ": " + value;
  }
  return "{" + out + "}";
}

std::string json_strings(const std::vector<std::string>& texts) {
  std::string out;
  for (const std::string& text : texts) out += (out.empty() ? "" : ", ") + json_string(text);
  return "[" + out + "]";
}

namespace {

std::string message_json(const Message& message) {
  std::string numbers;
  for (const auto& [name, value] : message.numbers) {
    numbers += (numbers.empty() ? "" : ", ") + json_string(name) + ": " + json_number(value);
  }
  std::string stretches;
  for (const PoseRange& stretch : message.stretches) {
    stretches += (stretches.empty() ? "[" : ", [") + std::to_string(stretch.first) + ", " +
                 std::to_string(stretch.last) + "]";
  }
  return "{\"code\": " + json_string(message.code) + ", \"message\": " + json_string(message.text) +
         ", \"numbers\": {" + numbers + "}" +
         (stretches.empty() ? "" : ", \"stretches\": [" + stretches + "]") + "}";
}

}  // namespace

std::string json_messages(const std::vector<Message>& messages) {
  std::string out;
  for (const Message& message : messages) out += (out.empty() ? "" : ", ") + message_json(message);
  return "[" + out + "]";
}

void JsonMembers::add(std::string_view name, const std::string& json) {
  text_ += (text_.empty() ? "  " : ",\n  ") + json_string(name) + ": " + json;
}

void JsonMembers::add_hash(std::string_view name, std::uint64_t hash) {
  add(name, json_string(hash_text(hash)));
}

}  // namespace clearway
