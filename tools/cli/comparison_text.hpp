#pragma once

#include <string>

#include "io/result/check/compare_results.hpp"

namespace clearway::tool {

/// A comparison in words, in many lines. a, b: the names of the compared files.
std::string comparison_text(const Comparison& comparison, const std::string& a,
                            const std::string& b);

/// A comparison as one JSON object, on one line. a, b: the names of the compared files.
std::string comparison_json(const Comparison& comparison, const std::string& a,
                            const std::string& b);

}  // namespace clearway::tool
