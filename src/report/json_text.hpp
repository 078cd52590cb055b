#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "clearway/vec3.hpp"
#include "core/util/format.hpp"

namespace clearway {

/// Writes JSON, a value after the other. "<" is escaped, so that the text may stand in a page.
class JsonText {
 public:
  JsonText& begin(char bracket) {
    separate();
    text_ += bracket;
    first_ = true;
    return *this;
  }
  JsonText& end(char bracket) {
    text_ += bracket;
    first_ = false;
    return *this;
  }
  JsonText& key(std::string_view name) {
    value(name);
    text_ += ':';
    first_ = true;  // no comma between a key and its value
    return *this;
  }
  JsonText& value(std::string_view text) {
    separate();
    text_ += '"';
    for (const char c : text) append_escaped(c);
    text_ += '"';
    return *this;
  }
  JsonText& value(const char* text) { return value(std::string_view(text)); }
  JsonText& value(bool flag) { return raw(flag ? "true" : "false"); }
  JsonText& value(std::unsigned_integral auto number) { return raw(std::to_string(number)); }
  JsonText& value(double number) { return raw(std::isfinite(number) ? digits(number) : "null"); }
  JsonText& value(const Vec3& p) {
    return begin('[').value(p.x).value(p.y).value(p.z).end(']');
  }
  template <typename Value>
  JsonText& value(const std::optional<Value>& value_or_none) {
    return value_or_none ? value(*value_or_none) : raw("null");
  }
  template <typename Value>
  JsonText& field(std::string_view name, const Value& of) {
    return key(name).value(of);
  }
  /// JSON as it is.
  JsonText& raw(std::string_view json) {
    separate();
    text_ += json;
    return *this;
  }

  const std::string& text() const { return text_; }

 private:
  static std::string digits(double number) { return format_number(number); }
  void separate() {
    if (!first_) text_ += ',';
    first_ = false;
  }
  void append_escaped(char c) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text_ += '\\';
      text_ += c;
    } else if (code < 0x20 || code == '<' || code == 0x7f) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04x", code);
      text_ += escaped;
    } else {
      text_ += c;
    }
  }

  std::string text_;
  bool first_ = true;
};

}  // namespace clearway
