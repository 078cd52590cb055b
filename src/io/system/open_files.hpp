#pragma once

#include <cstdint>
#include <string>

namespace clearway {

/// How many files a process that holds `more` beside those that it has may need to have open.
std::uint64_t needed_open_files(std::uint64_t more);

/// Throws ResourceError, naming the number and `ulimit -n`, where the soft limit is below
/// needed_open_files(more). purpose: "to merge 7 parts".
void require_open_files(std::uint64_t more, const std::string& purpose);

/// Raises the process's soft limit to needed_open_files(more) and some, as far as its hard limit
/// lets it.
/// For programs: a library leaves limits as they are.
void raise_open_files_limit(std::uint64_t more);

}  // namespace clearway
