#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace clearway {

/// A day of the calendar. Days compare by their order.
struct Day {
  int year = 0, month = 0, day = 0;
  friend auto operator<=>(const Day&, const Day&) = default;
};

/// How a table writes its days.
enum class DayForm {
  kIso,          ///< 2026-06-30
  kSlashedYear,  ///< 2026/06/30
  kDotted,       ///< 30.06.2026
  kDayFirst,     ///< 30/06/2026
  kMonthFirst    ///< 06/30/2026
};

/// A day as a text says it, and the form of the text; none where it can be read in two ways.
struct WrittenDay {
  Day day;
  std::optional<DayForm> form;
};

/// Reads a day in any of the forms, with years of four digits or two (20..), single digits, and a
/// time behind a day in ISO form, which does not count. Where day and month may be meant the other
/// way round, the earlier day is taken. None for any other text.
std::optional<WrittenDay> day_of(std::string_view text);

std::string text_of(const Day& day, DayForm form = DayForm::kIso);

/// The day in UTC on which this is called.
Day today();

}  // namespace clearway
