#pragma once

#include <string>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/progress.hpp"

namespace clearway {

/// Warns of conflicts that are of little use: "one-long-conflict" for a group that spans most of
/// the path. unit: the symbol of the unit of length.
std::vector<Message> conflict_warnings(const Conflicts& conflicts, const std::string& unit);

}  // namespace clearway
