#pragma once

#include <cstddef>
#include <string>

#include "io/conflicts/conflict_file.hpp"

namespace clearway::tool {

/// A table of the worst conflicts, ordered by least distance where that is known and otherwise
/// along the path. At most `most` are shown; the others are counted.
std::string conflict_text(const ConflictFile& file, std::size_t most);

}  // namespace clearway::tool
