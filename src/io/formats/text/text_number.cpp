#include "io/formats/text/text_number.hpp"

#include <cmath>
#include <cstdlib>
#include <string>

namespace clearway {

bool parse_extreme_number(const char* begin, const char* end, double& value) {
  value = std::strtod(std::string(begin, end).c_str(), nullptr);
  return std::isfinite(value);
}

std::optional<std::size_t> parse_number_line(std::string_view line, std::span<double> out) {
  const char* end = line.data() + line.size();
  const char* at = skip_blanks(line.data(), end);
  char kind = 0;
  std::size_t count = 0;
  while (at != end) {
    double value = 0;
    if (!parse_number(at, end, value)) return std::nullopt;
    if (count < out.size()) out[count] = value;
    ++count;
    const char separator = skip_separator(at, end);
    if (at == end) {
      if (separator == ',' || separator == ';') return std::nullopt;
      break;
    }
    if (separator == 0 || (kind != 0 && separator != kind)) return std::nullopt;
    kind = separator;
  }
  return count > out.size() ? out.size() + 1 : count;
}

std::optional<double> parse_whole_number(std::string_view field) {
  const char* end = field.data() + field.size();
  const char* at = skip_blanks(field.data(), end);
  double value = 0;
  if (!parse_number(at, end, value) || skip_blanks(at, end) != end) return std::nullopt;
  return value;
}

}  // namespace clearway
