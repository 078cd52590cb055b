#include "io/formats/e57/e57_remarks.hpp"

#include <algorithm>
#include <cmath>

#include "core/util/format.hpp"
#include "io/formats/declared_box.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

Message note(std::string text, std::vector<std::pair<std::string, double>> numbers) {
  return {Message::Severity::kNote, {}, std::move(text), std::move(numbers)};
}

std::string scans(std::uint64_t count) {
  return format_count(count) + (count == 1 ? " scan" : " scans");
}

}  // namespace

void E57Remarks::add(const E57Scan& scan, const E57Findings& findings) {
  ++scans_;
  records_ += scan.records;
  absent_ += findings.absent;
  if (scan.records == 0) ++empty_;
  if (scan.pose && scan.records > 0) ++posed_;
  // By the standard, bounds are those of the points before the pose is applied; some writers give
  // those after it.
  if (!scan.bounds || !goes_far_beyond(*scan.bounds, findings.own) ||
      (findings.posed && !goes_far_beyond(*scan.bounds, findings.posed))) {
    return;
  }
  if (beyond_bounds_++ == 0) {
    first_beyond_bounds_ = scan.name() + " declares " + declared_box_text(*scan.bounds) +
                           " and has " + declared_box_text(*findings.own);
  }
}

std::vector<Message> E57Remarks::messages(const std::string& file) const {
  std::vector<Message> all;
  const auto number = [](std::uint64_t value) { return static_cast<double>(value); };
  if (scans_ > 1 || posed_ > 0) {
    const std::string poses = posed_ == 0   ? "; none has a pose"
                              : posed_ == 1 ? "; 1 pose is applied"
                                            : "; " + format_count(posed_) + " poses are applied";
    all.push_back(note(file + ": " + scans(scans_) + poses,
                       {{"scans", number(scans_)}, {"poses", number(posed_)}}));
  }
  if (empty_ > 0) {
    all.push_back(note(file + ": " + scans(empty_) + " without points, of " + format_count(scans_),
                       {{"empty_scans", number(empty_)}, {"scans", number(scans_)}}));
  }
  if (without_coordinates_ > 0) {
    all.push_back(note(
        file + ": " + scans(without_coordinates_) + " without coordinates, of " +
            format_count(scans_) + "; their records are not counted",
        {{"scans_without_coordinates", number(without_coordinates_)}, {"scans", number(scans_)}}));
  }
  if (absent_ > 0) {
    all.push_back(note(file + ": " + format_count(absent_) + " of " + format_count(records_) +
                           " records have no valid point",
                       {{"absent", number(absent_)}, {"records", number(records_)}}));
  }
  if (beyond_bounds_ > 0) {
    all.push_back({Message::Severity::kWarning,
                   "declared-bounds",
                   file + ": " + scans(beyond_bounds_) +
                       " with points far beyond the declared bounds (" + first_beyond_bounds_ +
                       ", metres). Is the unit of length right?",
                   {{"scans_beyond_bounds", number(beyond_bounds_)}}});
  }
  return all;
}

}  // namespace clearway
