#pragma once

#include <string>

#include "search/checks/facts/path_cover.hpp"
#include "search/checks/question.hpp"

namespace clearway {

/// A sentence that tells how model, path and environment would meet: in another unit, with axes
/// swapped, with the poses inverted, or after a shift. It is a guess for people; nothing is
/// changed. Where no such change helps, it names what to compare.
std::string likely_remedy(const Question& question, const PathCover& cover);

}  // namespace clearway
