#include <algorithm>
#include <cmath>
#include <string>

#include "core/trajectory/follow/follow_path.hpp"
#include "core/util/format.hpp"
#include "core/util/number_ranges.hpp"

namespace clearway {
namespace {

/// The poses as text, such as "poses 0-99, 901-1000", or the first few of many such runs.
std::string listed(const std::vector<std::uint64_t>& indices) {
  constexpr std::size_t kMost = 4;
  const auto ranges = number_ranges(indices);
  std::string text = indices.size() == 1 ? "pose " : "poses ";
  for (std::size_t k = 0; k < std::min(ranges.size(), kMost); ++k) {
    text += (k > 0 ? ", " : "") + ranges[k];
  }
  return ranges.size() > kMost ? text + " and others" : text;
}

/// A length in metres as text, rounded to a millimetre.
std::string metres_text(double metres) { return format_number(std::round(metres * 1e3) / 1e3); }

/// Whether the given poses, which ascend, all belong to runs at the beginning or the end of the
/// path.
bool only_at_ends(const std::vector<std::uint64_t>& poses, std::size_t count) {
  std::size_t first = 0, last = 0;
  while (first < poses.size() && poses[first] == first) ++first;
  while (last < poses.size() && poses[poses.size() - 1 - last] == count - 1 - last) ++last;
  return first + last >= poses.size();
}

Message message(Message::Severity severity, const std::string& code, const std::string& text,
                const std::vector<std::uint64_t>& poses) {
  return {severity,
          code,
          text,
          {{"poses", static_cast<double>(poses.size())},
           {"first", static_cast<double>(poses.front())},
           {"last", static_cast<double>(poses.back())}}};
}

}  // namespace

std::vector<Message> doubts_about(const FollowedPath& followed, const PathStations& path,
                                  const BodyMount& mount, const std::string& name) {
  std::vector<Message> doubts;
  const std::size_t count = path.poses().size();
  const auto tell = [&](Message::Severity severity, const std::string& code,
                        const std::vector<std::uint64_t>& poses, const std::string& what) {
    if (poses.empty()) return;
    const std::string share = name + ": " + format_count(poses.size()) + " of " +
                              counted(count, "pose") + " of the path (" + listed(poses) +
                              ", from 0): ";
    doubts.push_back(message(severity, code, share + what, poses));
  };
  const auto warn = [&](const std::string& code, const std::vector<std::uint64_t>& poses,
                        const std::string& what) {
    tell(Message::Severity::kWarning, code, poses, what);
  };
  const bool pivots = std::holds_alternative<BodyPivots>(mount);
  // A wagon on pivots leaves the ends of any path, and the verdict says how much of it was
  // searched. A body that is missing on most of the path is different, because the answer is hardly
  // about it.
  const bool mostly = followed.off_path.size() > count / 2;
  const bool expected = !mostly && only_at_ends(followed.off_path, count);
  tell(expected ? Message::Severity::kNote : Message::Severity::kWarning, "body-off-path",
       followed.off_path,
       std::string("the body has no pose there, as ") + (pivots ? "a pivot" : "its station") +
           " is off the path, which is " + metres_text(path.length()) + " m long. " +
           (mostly ? "Most of the path is not searched for this body. Check its stations, or make "
                     "the path longer"
                   : "Make the path longer to search there too"));
  warn("body-undefined", followed.undefined,
       "the body has no pose there. Its pivots are at one place, or one is above the other. The "
       "path turns back there, or stands on its end");
  warn("body-folded", followed.folded,
       "the path turns back between the pivots. They are closer together than half their way "
       "along the path. Split the path where it turns back");
  warn("body-turned", followed.turned,
       pivots
           ? "the path's x axis is more than 60 degrees from the body's, or its z axis within 30. "
             "If the path is driven backwards, give the pivots the other way round. Otherwise its "
             "poses may have other axes than x forward and z up"
           : "the path is driven against its x axis. Stations ahead are behind the model there");
  return doubts;
}

}  // namespace clearway
