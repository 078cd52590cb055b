#pragma once

#include <optional>
#include <string>

#include "clearway/box.hpp"

namespace clearway {

/// Whether the found points go farther out of the box that a file declares than its own size.
/// Writers round their bounds, and a wrong unit or records of zeros are far more. A box without any
/// extent was never filled in.
bool goes_far_beyond(const Box& declared, const std::optional<Box>& found);

/// "(1, 2, 3) to (4, 5, 6)"
std::string declared_box_text(const Box& box);

}  // namespace clearway
