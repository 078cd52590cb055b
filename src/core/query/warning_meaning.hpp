#pragma once

#include <string_view>

#include "clearway/progress.hpp"

namespace clearway {

/// Whether a search that gave a warning with this code may have missed points: they may be missing
/// from the scan, or the model may not have been where they are. So what an earlier search found
/// there may be there still. Every doubt is such a code, and every code that lacks_points().
bool may_miss(std::string_view code);

/// Whether two warnings name the same fault, wherever on the path it is: they have the same code
/// and, where they are about one side of the path, the same side.
bool have_same_fault(const Message& a, const Message& b);

}  // namespace clearway
