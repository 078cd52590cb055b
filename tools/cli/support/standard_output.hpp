#pragma once

#include <string_view>

namespace clearway::tool {

/// Writes to standard output, through to the system. Throws ResourceError where that fails.
void print(std::string_view text);

/// A standard descriptor that is closed would become an output's, and what is printed would be
/// written into it. What is then read or printed fails, but for messages, which are lost.
void occupy_standard_descriptors();

}  // namespace clearway::tool
