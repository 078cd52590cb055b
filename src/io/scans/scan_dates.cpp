#include "io/scans/scan_dates.hpp"

#include <string_view>

#include "io/files/input_error.hpp"

namespace clearway {
namespace {

constexpr const char* kFirstDate = "first_date";
constexpr const char* kLastDate = "last_date";

std::string read_date(const hdf5::Id& file, const char* attribute, const std::string& name) {
  constexpr std::string_view kForm = "0000-00-00";
  std::string date = hdf5::read_text_attribute(file, attribute, name);
  bool good = date.size() == kForm.size();
  for (std::size_t i = 0; good && i < kForm.size(); ++i) {
    const bool is_digit = date[i] >= '0' && date[i] <= '9';
    good = kForm[i] == '0' ? is_digit : date[i] == kForm[i];
  }
  if (good) return date;
  refuse(name, "attribute '" + std::string(attribute) + "': expected a day such as 2024-05-31");
}

}  // namespace

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
