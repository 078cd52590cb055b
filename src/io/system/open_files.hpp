#pragma once

#include <cstdint>
#include <string>

namespace clearway {

/// Number of files that a process may need to have open if it opens `more` than it has.
std::uint64_t needed_open_files(std::uint64_t more);

/// Throws ResourceError, which names the number and `ulimit -n`, where the soft limit is below
/// needed_open_files(more). purpose: as in "to merge 7 parts".
void require_open_files(std::uint64_t more, const std::string& purpose);

/// Raises the process's soft limit somewhat above needed_open_files(more), as far as its hard limit
/// allows. Only for programs: a library leaves limits as they are.
void raise_open_files_limit(std::uint64_t more);

}  // namespace clearway
