#include "io/formats/e57/e57_remarks.hpp"

#include <algorithm>
#include <cmath>

#include "core/util/format.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

/// "(1, 2, 3) to (4, 5, 6)"
std::string text_of(const Box& box) {
  const auto corner = [](const Vec3& p) {
    return "(" + brief(p.x) + ", " + brief(p.y) + ", " + brief(p.z) + ")";
  };
  return corner(box.lo) + " to " + corner(box.hi);
}

/// Whether the found points go farther out of the declared box than its own size. Writers round
/// their bounds, and a wrong unit is far more. A box without any extent was never filled in.
bool goes_far_beyond(const Box& declared, const std::optional<Box>& found) {
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max(size, declared.hi[k] - declared.lo[k]);
  if (!found || !(size > 0)) return false;
  for (int k = 0; k < 3; ++k) {
    if (found->lo[k] < declared.lo[k] - size || found->hi[k] > declared.hi[k] + size) return true;
  }
  return false;
}

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
  // By the standard the bounds are those before the pose; some writers give those after it.
  if (!scan.bounds || !goes_far_beyond(*scan.bounds, findings.own) ||
      (findings.posed && !goes_far_beyond(*scan.bounds, findings.posed))) {
    return;
  }
  if (beyond_bounds_++ == 0) {
    first_beyond_bounds_ =
        scan.name() + " declares " + text_of(*scan.bounds) + " and has " + text_of(*findings.own);
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
