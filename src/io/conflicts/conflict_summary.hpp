#pragma once

#include <string>

#include "io/conflicts/conflict_file.hpp"

namespace clearway {

/// The members of a JSON object about the whole result, without the braces, each on a line that
/// begins with two blanks: the query, hashes, how conflicts were made, counts and warnings.
std::string summary_json(const ConflictFile& file);

}  // namespace clearway
