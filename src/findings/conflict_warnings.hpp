#pragma once

#include <string>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/progress.hpp"

namespace clearway {

/// What makes conflicts of little use: "one-long-conflict", a group that spans most of the path.
/// unit: the symbol of lengths.
std::vector<Message> conflict_warnings(const Conflicts& conflicts, const std::string& unit);

}  // namespace clearway
