#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "clearway/file_unit.hpp"

namespace clearway {

inline bool is_blank(char c) { return c == ' ' || c == '\t'; }

inline const char* skip_blanks(const char* at, const char* end) {
  while (at != end && is_blank(*at)) ++at;
  return at;
}

/// Parses with strtod a number that std::from_chars finds out of range. One that is too small gives
/// 0 or the nearest number; one that is too large is refused (false).
bool parse_extreme_number(const char* begin, const char* end, double& value);

/// Parses a number in double quotes, as some programs write the cells of a table, and moves `at`
/// behind the second quote.
bool parse_quoted_number(const char*& at, const char* end, double& value);

/// Parses the number that starts at `at` (including nan, inf, a leading + and double quotes around
/// it) and moves `at` past it. Returns false where there is none. The caller checks what follows.
inline bool parse_number(const char*& at, const char* end, double& value) {
  if (at != end && *at == '"') return parse_quoted_number(at, end, value);
  const char* start = at;
  if (start != end && *start == '+' && end - start > 1 && start[1] != '-') ++start;
  const auto [stop, error] = std::from_chars(start, end, value);
  if (error == std::errc::invalid_argument) return false;
  if (error != std::errc() && !parse_extreme_number(start, stop, value)) return false;
  at = stop;
  return true;
}

/// Skips the separator between two numbers: blanks, or one comma or semicolon with or without
/// blanks around it. Returns ',', ';' or ' ' for blanks alone, and 0 where there is none.
inline char skip_separator(const char*& at, const char* end) {
  const char* const start = at;
  at = skip_blanks(at, end);
  if (at != end && (*at == ',' || *at == ';')) {
    const char separator = *at;
    at = skip_blanks(at + 1, end);
    return separator;
  }
  return at != start ? ' ' : '\0';
}

/// Parses a line that consists of nothing but numbers, up to out.size() of them, separated by
/// blanks, commas or semicolons, of one kind throughout. Returns how many there are (out.size() + 1
/// for more); nullopt for anything else in the line.
std::optional<std::size_t> parse_number_line(std::string_view line, std::span<double> out);

/// Parses a whole word as a whole number from 0; nullopt for anything else and for one that is too
/// large.
inline std::optional<std::uint64_t> parse_count(std::string_view word) {
  std::uint64_t value = 0;
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

/// Parses a whole field, apart from blanks and double quotes around it, as a number.
std::optional<double> parse_whole_number(std::string_view field);

/// A length given as text: "0.1", "10cm", "4 in", "0.5 us-ft".
struct ParsedLength {
  double value = 0;  ///< metres where a unit was given, otherwise the number
  /// Whether a unit was given; otherwise the number is in the unit of the file it is compared with.
  bool has_unit = false;
  double feet = 0;     ///< the length in international feet, where a unit was given
  double number = 0;   ///< the number as written
  FileUnit unit = {};  ///< the unit as written

  /// Converts the length to the unit that is `metres` metres long. If that unit is a foot, "ft",
  /// which may be any foot, means that one.
  double in_units_of(double metres) const;
};

/// Parses a number, alone or followed by the name of a unit of length; nullopt where the text is
/// anything else or not finite. A decimal becomes the nearest double, so "10cm" gives the same as
/// "0.1".
std::optional<ParsedLength> length_of(std::string_view text);

}  // namespace clearway
