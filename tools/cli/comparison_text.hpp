#pragma once

#include <string>

#include "io/result/check/compare_results.hpp"

namespace clearway::tool {

/// A comparison in words, many lines. a, b: the files' names.
std::string comparison_text(const Comparison& comparison, const std::string& a,
                            const std::string& b);

/// The same as one JSON object, one line.
std::string comparison_json(const Comparison& comparison, const std::string& a,
                            const std::string& b);

}  // namespace clearway::tool
