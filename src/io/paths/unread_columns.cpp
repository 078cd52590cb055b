#include "io/paths/unread_columns.hpp"

#include <algorithm>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>

#include "core/util/format.hpp"
#include "io/files/input_error.hpp"

namespace clearway {
namespace {

using Words = std::span<const std::string_view>;

// Words that a name may begin with, and those that one of its parts must be equal to.
constexpr std::string_view kCantBegins[] = {
    "superel",      "crossfall",    "crossslope", "cross_slope", "appliedcant",
    "applied_cant", "ueberhoehung", "uberhohung", "\u00FCberh",  "\u00DCberh"};
constexpr std::string_view kCantWords[] = {"cant", "devers", "d\u00E9vers"};
constexpr std::string_view kRollBegins[] = {"banking", "camber"};
constexpr std::string_view kRollWords[] = {"roll", "bank", "tilt", "lean"};
constexpr std::string_view kHeightBegins[] = {"height", "elev", "altitude", "hoehe", "h\u00F6he"};
constexpr std::string_view kHeightWords[] = {"z", "h", "alt", "hgt", "level"};

/// Whether a name begins with one of `begins`, or one of its parts between marks such as _ is one
/// of `words`. Digits at the end of a part do not count.
bool says(std::string_view name, Words begins, Words words) {
  const auto starts = [name](std::string_view begin) { return name.starts_with(begin); };
  if (std::ranges::any_of(begins, starts)) return true;
  constexpr std::string_view kMarks = "_.-/:";
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t end = std::min(name.find_first_of(kMarks, at), name.size());
    std::string_view part = name.substr(at, end - at);
    part = part.substr(0, part.find_last_not_of("0123456789") + 1);
    if (std::ranges::find(words, part) != words.end()) return true;
    at = end + 1;
  }
  return false;
}

bool matters(std::string_view name, PathTable table) {
  if (says(name, kCantBegins, kCantWords)) return true;
  if (table == PathTable::kPoses) return false;
  if (says(name, kRollBegins, kRollWords)) return true;
  return table == PathTable::kLine && says(name, kHeightBegins, kHeightWords);
}

}  // namespace

void remark_unread_columns(const std::string& file, const std::vector<std::string>& names,
                           PathTable table, Remarks& out) {
  if (names.empty()) return;
  std::vector<std::string> doubtful;
  std::ranges::copy_if(names, std::back_inserter(doubtful),
                       [&](const std::string& name) { return matters(name, table); });
  const bool one = names.size() == 1;
  const std::string text = file + ": " + counted(names.size(), "column") + (one ? " is" : " are") +
                           " not read: " + listed(names);
  const std::vector<std::pair<std::string, double>> numbers{{"columns", names.size()}};
  if (doubtful.empty()) {
    out.note("unread-columns", text, numbers);
    return;
  }
  const std::string advice =
      table == PathTable::kPoses
          ? "Only the rotations say how far the poses lean, so make sure that they contain it"
      : table == PathTable::kLine
          ? "Cant is read from a column cant and heights from a column z, so rename or remove it"
          : "Cant is read from a column cant, so rename or remove it";
  out.warn("unread-columns",
           text + ". By its name, " + excerpt(doubtful[0]) +
               " may say how far the vehicle leans or how high it is. " + advice,
           numbers);
}

}  // namespace clearway
