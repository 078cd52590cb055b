#include "findings/ledger/ledger_date.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <string>

#include "io/files/text_number.hpp"

namespace clearway {
namespace {

bool is_day(const Day& day) {
  using namespace std::chrono;
  return year_month_day(year(day.year), month(static_cast<unsigned>(day.month)),
                        std::chrono::day(static_cast<unsigned>(day.day)))
      .ok();
}

/// A year of two digits is one of this century.
int full_year(int year, std::size_t digits) { return digits == 2 ? 2000 + year : year; }

struct Number {
  int value;
  std::size_t digits;
};

/// Three numbers of digits between two equal separators; the separator is 0 for anything else.
struct ThreeNumbers {
  std::array<Number, 3> numbers{};
  char separator = 0;
};

ThreeNumbers three_numbers(std::string_view text) {
  ThreeNumbers out;
  const std::size_t first = text.find_first_of("-./");
  if (first == std::string_view::npos) return {};
  const char separator = text[first];
  const std::size_t second = text.find(separator, first + 1);
  if (second == std::string_view::npos) return {};
  const std::array parts{text.substr(0, first), text.substr(first + 1, second - first - 1),
                         text.substr(second + 1)};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string_view part = parts[i];
    if (part.empty() || part.size() > 4) return {};
    const auto [end, error] =
        std::from_chars(part.data(), part.data() + part.size(), out.numbers[i].value);
    if (error != std::errc() || end != part.data() + part.size()) return {};
    if (out.numbers[i].value < 0) return {};
    out.numbers[i].digits = part.size();
  }
  out.separator = separator;
  return out;
}

}  // namespace

std::optional<WrittenDay> day_of(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  // A time behind the day, as in 2026-06-30T12:00:00Z or 2026-06-30 00:00:00.
  if (text.size() > 10 && text[4] == '-' && (text[10] == 'T' || text[10] == ' ')) {
    text = text.substr(0, 10);
  }
  const ThreeNumbers read = three_numbers(text);
  const auto& [a, b, c] = read.numbers;
  if (read.separator == 0) return std::nullopt;
  const auto found = [](const Day& day, std::optional<DayForm> form) -> std::optional<WrittenDay> {
    return is_day(day) ? std::optional(WrittenDay{day, form}) : std::nullopt;
  };
  if (a.digits == 4) {
    if (read.separator == '.') return std::nullopt;
    return found({a.value, b.value, c.value},
                 read.separator == '-' ? DayForm::kIso : DayForm::kSlashedYear);
  }
  if (c.digits != 4 && c.digits != 2) return std::nullopt;
  const int year = full_year(c.value, c.digits);
  if (read.separator == '.') return found({year, b.value, a.value}, DayForm::kDotted);
  if (read.separator == '-' && c.digits == 2) return std::nullopt;  // its year may come first
  const Day day_first{year, b.value, a.value}, month_first{year, a.value, b.value};
  if (!is_day(day_first)) return found(month_first, DayForm::kMonthFirst);
  if (!is_day(month_first)) return found(day_first, DayForm::kDayFirst);
  if (day_first == month_first) return found(day_first, std::nullopt);
  return found(std::min(day_first, month_first), std::nullopt);
}

std::string text_of(const Day& day, DayForm form) {
  const auto padded = [](int number, std::size_t digits) {
    const std::string text = std::to_string(number);
    return std::string(digits - std::min(digits, text.size()), '0') + text;
  };
  const std::string y = padded(day.year, 4), m = padded(day.month, 2), d = padded(day.day, 2);
  switch (form) {
    case DayForm::kIso:
      break;
    case DayForm::kSlashedYear:
      return y + "/" + m + "/" + d;
    case DayForm::kDotted:
      return d + "." + m + "." + y;
    case DayForm::kDayFirst:
      return d + "/" + m + "/" + y;
    case DayForm::kMonthFirst:
      return m + "/" + d + "/" + y;
  }
  return y + "-" + m + "-" + d;
}

Day today() {
  using namespace std::chrono;
  const year_month_day now(floor<days>(system_clock::now()));
  return {static_cast<int>(now.year()), static_cast<int>(static_cast<unsigned>(now.month())),
          static_cast<int>(static_cast<unsigned>(now.day()))};
}

}  // namespace clearway
