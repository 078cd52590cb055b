#pragma once

#include <cstdint>
#include <optional>

#include "core/geometry/quantisation.hpp"

namespace clearway {

/// The stored integer whose coordinate is exactly `x`; none when no integer's is. Where the scale
/// is below the spacing of doubles at `x`, several are: any one of them.
std::optional<std::int32_t> quantum_at(const Quantisation& quantisation, int axis, double x);

}  // namespace clearway
