#pragma once

#include <optional>
#include <string>

#include "clearway/box.hpp"

namespace clearway {

/// Whether a writer filled in the box that a file declares: it is finite, not inverted and not a
/// single place.
bool is_filled_in(const Box& declared);

/// Whether the points found lie outside the box that a file declares by more than the box's own
/// size. Writers round their bounds, so small excesses are normal; a wrong unit or records of zeros
/// exceed them by far. A box that was not filled in does not count.
bool goes_far_beyond(const Box& declared, const std::optional<Box>& found);

/// The box as "(1, 2, 3) to (4, 5, 6)".
std::string declared_box_text(const Box& box);

}  // namespace clearway
