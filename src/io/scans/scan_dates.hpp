#pragma once

#include <algorithm>
#include <string>

namespace clearway {

class HeaderValues;

/// The days on which scans were made, as far as their files say, in the form "2024-05-31", whose
/// order is that of the days. Both are empty where no file says.
struct ScanDates {
  std::string first = {}, last = {};

  bool known() const { return !first.empty(); }
  /// Takes in the day of one more file; nothing where it is empty.
  void add(const std::string& day) {
    if (day.empty()) return;
    first = known() ? std::min(first, day) : day;
    last = std::max(last, day);
  }
  friend bool operator==(const ScanDates&, const ScanDates&) = default;
};

/// What the header of a file keeps. Throws InputError for what is no day.
void keep_facts(HeaderValues& values, ScanDates& dates);

}  // namespace clearway
