#pragma once

#include <string>

#include "io/conflicts/conflict_file.hpp"

namespace clearway {

/// The members of a JSON object about the whole, each on a line with two blanks before it, without
/// the braces: the query, hashes, how conflicts were made, counts and warnings.
std::string summary_json(const ConflictFile& file);

}  // namespace clearway
