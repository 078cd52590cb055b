#pragma once

#include <cstdint>
#include <optional>

#include "core/geometry/quantisation.hpp"

namespace clearway {

/// The stored integer whose coordinate is exactly `x`; nullopt where there is none. Where the scale
/// is smaller than the spacing of doubles at `x`, several integers match and any one of them is
/// returned.
std::optional<std::int32_t> quantum_at(const Quantisation& quantisation, int axis, double x);

}  // namespace clearway
