#pragma once

#include <string_view>

namespace clearway::tool {

/// Writes to standard output, through to the system. Throws ResourceError where that fails.
void print(std::string_view text);

}  // namespace clearway::tool
