#include "io/scans/scan_dates.hpp"

#include <string_view>

#include "io/files/header_values.hpp"
#include "io/files/input_error.hpp"

namespace clearway {
namespace {

constexpr const char* kFirstDate = "first_date";
constexpr const char* kLastDate = "last_date";

bool is_day(const std::string& day) {
  constexpr std::string_view kForm = "0000-00-00";
  bool good = day.size() == kForm.size();
  for (std::size_t i = 0; good && i < kForm.size(); ++i) {
    const bool is_digit = day[i] >= '0' && day[i] <= '9';
    good = kForm[i] == '0' ? is_digit : day[i] == kForm[i];
  }
  return good;
}

std::string read_date(const hdf5::Id& file, const char* attribute, const std::string& name) {
  std::string date = hdf5::read_text_attribute(file, attribute, name);
  if (is_day(date)) return date;
  refuse(name, "attribute '" + std::string(attribute) + "': expected a day such as 2024-05-31");
}

}  // namespace

void keep_facts(HeaderValues& values, ScanDates& dates) {
  values.add("first", dates.first);
  values.add("last", dates.last);
  if (!is_day(dates.first) || !is_day(dates.last)) {
    values.refuse_fact("first", "days such as 2024-05-31");
  }
}

void write_scan_dates(const hdf5::Id& file, const ScanDates& dates) {
  if (!dates.known()) return;
  hdf5::write_attribute(file, kFirstDate, dates.first);
  hdf5::write_attribute(file, kLastDate, dates.last);
}

ScanDates read_scan_dates(const hdf5::Id& file, const std::string& name) {
  if (!hdf5::has_attribute(file, kFirstDate, name)) return {};
  return {read_date(file, kFirstDate, name), read_date(file, kLastDate, name)};
}

}  // namespace clearway
