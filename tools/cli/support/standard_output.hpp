#pragma once

#include <string_view>

namespace clearway::tool {

/// Writes to standard output and flushes. Throws ResourceError where that fails.
void print(std::string_view text);

/// Opens standard descriptors that are closed, because otherwise an output file would get such a
/// descriptor, and what is printed would be written into it. Reading and printing through them then
/// fail, but messages are lost silently.
void occupy_standard_descriptors();

}  // namespace clearway::tool
