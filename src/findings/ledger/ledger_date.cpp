#include "findings/ledger/ledger_date.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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

/// Three numbers of digits between two equal separators.
struct ThreeNumbers {
  std::array<int, 3> values{};
  std::array<std::size_t, 3> digits{};
  char separator = 0;
};

std::optional<ThreeNumbers> three_numbers(std::string_view text) {
  ThreeNumbers out;
  const std::size_t first = text.find_first_of("-./");
  if (first == std::string_view::npos) return std::nullopt;
  out.separator = text[first];
  const std::size_t second = text.find(out.separator, first + 1);
  if (second == std::string_view::npos) return std::nullopt;
  const std::array parts{text.substr(0, first), text.substr(first + 1, second - first - 1),
                         text.substr(second + 1)};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto read = parts[i].size() > 4 ? std::nullopt : parse_count(parts[i]);
    if (!read) return std::nullopt;
    out.values[i] = static_cast<int>(*read);
    out.digits[i] = parts[i].size();
  }
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
  const auto read = three_numbers(text);
  if (!read) return std::nullopt;
  const auto& [a, b, c] = read->values;
  const std::size_t last_digits = read->digits[2];
  const char separator = read->separator;
  const auto found = [](const Day& day, std::optional<DayForm> form) -> std::optional<WrittenDay> {
    return is_day(day) ? std::optional(WrittenDay{day, form}) : std::nullopt;
  };
  if (read->digits[0] == 4) {
    if (separator == '.') return std::nullopt;
    return found({a, b, c}, separator == '-' ? DayForm::kIso : DayForm::kSlashedYear);
  }
  if (last_digits != 4 && last_digits != 2) return std::nullopt;
  const int year = last_digits == 2 ? 2000 + c : c;  // of this century
  if (separator == '.') return found({year, b, a}, DayForm::kDotted);
  if (separator == '-' && last_digits == 2) return std::nullopt;  // its year may come first
  const Day day_first{year, b, a}, month_first{year, a, b};
  if (!is_day(day_first)) return found(month_first, DayForm::kMonthFirst);
  if (!is_day(month_first)) return found(day_first, DayForm::kDayFirst);
  if (day_first == month_first) return found(day_first, std::nullopt);
  return found(std::min(day_first, month_first), std::nullopt);
}

std::string text_of(const Day& day, DayForm form) {
  constexpr std::array kForms{"{0:04}-{1:02}-{2:02}", "{0:04}/{1:02}/{2:02}",
                              "{2:02}.{1:02}.{0:04}", "{2:02}/{1:02}/{0:04}",
                              "{1:02}/{2:02}/{0:04}"};
  return fmt::format(fmt::runtime(kForms[static_cast<std::size_t>(form)]), day.year, day.month,
                     day.day);
}

Day today() {
  using namespace std::chrono;
  const year_month_day now(floor<days>(system_clock::now()));
  return {static_cast<int>(now.year()), static_cast<int>(static_cast<unsigned>(now.month())),
          static_cast<int>(static_cast<unsigned>(now.day()))};
}

}  // namespace clearway
