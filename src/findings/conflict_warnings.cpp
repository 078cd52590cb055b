#include "findings/conflict_warnings.hpp"

#include "core/util/format.hpp"

namespace clearway {
namespace {

constexpr double kMostOfThePath = 0.5;

}  // namespace

std::vector<Message> conflict_warnings(const Conflicts& conflicts, const std::string& unit) {
  const double length = conflicts.longest_group;
  if (!(length > 0 && length >= kMostOfThePath * conflicts.path_length)) return {};
  return {{Message::Severity::kWarning,
           "one-long-conflict",
           "one group of " + counted(conflicts.longest_group_points, "point") + " spans " +
               format_brief(length) + " " + unit + " of " + format_brief(conflicts.path_length) +
               " " + unit + " of path, as wheels do that stand on the ground",
           {{"points", static_cast<double>(conflicts.longest_group_points)},
            {"length", length},
            {"path_length", conflicts.path_length}}}};
}

}  // namespace clearway
