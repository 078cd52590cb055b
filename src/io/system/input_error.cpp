#include "io/system/input_error.hpp"

#include <charconv>
#include <cstdio>

#include "clearway/error.hpp"

namespace clearway {

void refuse(const std::string& name, const std::string& what, Remedy remedy, double amount) {
  throw InputError(name + ": " + what, remedy, amount);
}

void refuse_byte(const std::string& name, std::uint64_t byte, const std::string& what) {
  refuse(name, "byte " + std::to_string(byte) + ": " + what);
}

void refuse_line(const std::string& name, std::uint64_t line, const std::string& what,
                 Remedy remedy) {
  refuse(name, "line " + std::to_string(line) + ": " + what, remedy);
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string result = "\"";
  for (const char c : text.substr(0, kLongest)) {
    result += c == '\t' ? ' ' : c >= ' ' && c <= '~' ? c : '?';
  }
  return result + (text.size() > kLongest ? "...\"" : "\"");
}

std::string shown(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

std::string brief(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.9g", value);
  return digits;
}

}  // namespace clearway
