#pragma once

#include <cmath>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>

#include "clearway/vec3.hpp"
#include "core/util/format.hpp"
#include "io/result/conflicts/json_text.hpp"

namespace clearway {

/// Writes JSON, one value after the other. "<" is escaped, so that the text may stand in a page.
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
    for (const char c : json_string(text)) {
      if (c == '<') {
        text_ += "\\u003c";
      } else {
        text_ += c;
      }
    }
    return *this;
  }
  JsonText& value(const char* text) { return value(std::string_view(text)); }
  JsonText& value(bool flag) { return raw(flag ? "true" : "false"); }
  JsonText& value(std::unsigned_integral auto number) { return raw(std::to_string(number)); }
  JsonText& value(double number) { return raw(std::isfinite(number) ? digits(number) : "null"); }
  JsonText& value(const Vec3& p) { return begin('[').value(p.x).value(p.y).value(p.z).end(']'); }
  template <typename Value>
  JsonText& value(const std::optional<Value>& value_or_none) {
    return value_or_none ? value(*value_or_none) : raw("null");
  }
  template <typename Value>
  JsonText& field(std::string_view name, const Value& of) {
    return key(name).value(of);
  }
  /// Appends a string that is already JSON.
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
  std::string text_;
  bool first_ = true;
};

}  // namespace clearway
