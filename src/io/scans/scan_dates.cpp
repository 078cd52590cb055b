#include "io/scans/scan_dates.hpp"

#include <string_view>

#include "io/files/header_values.hpp"
#include "io/files/input_error.hpp"

namespace clearway {
namespace {

bool is_day(const std::string& day) {
  constexpr std::string_view kForm = "0000-00-00";
  bool good = day.size() == kForm.size();
  for (std::size_t i = 0; good && i < kForm.size(); ++i) {
    const bool is_digit = day[i] >= '0' && day[i] <= '9';
    good = kForm[i] == '0' ? is_digit : day[i] == kForm[i];
  }
  return good;
}

}  // namespace

void keep_facts(HeaderValues& values, ScanDates& dates) {
  values.add("first", dates.first);
  values.add("last", dates.last);
  if (values.reads() && (!is_day(dates.first) || !is_day(dates.last))) {
    values.refuse_fact("first", "days such as 2024-05-31");
  }
}

}  // namespace clearway
