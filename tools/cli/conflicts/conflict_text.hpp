#pragma once

#include <cstddef>
#include <string>

#include "io/conflicts/conflict_file.hpp"

namespace clearway::tool {

/// A table of the worst conflicts: by their least distance where that is known, otherwise along the
/// path. At most `most` of them; what is left out is counted.
std::string conflict_text(const ConflictFile& file, std::size_t most);

}  // namespace clearway::tool
