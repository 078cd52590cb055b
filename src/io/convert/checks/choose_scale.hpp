#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "core/geometry/quantisation.hpp"
#include "io/convert/checks/coordinate_range.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// The coarsest step in metres that a conversion chooses by itself.
inline constexpr double kCoarsestOwnScale = 1e-3;

/// Offset and scale for positions of this range: the requested scale, otherwise the finest power of
/// ten from 1e-6 that fits. Throws InputError where the range does not fit 32-bit integers, or
/// needs steps coarser than kCoarsestOwnScale that were not requested. The message names the points
/// that lie far from all others, with their lines where the files have lines.
Quantisation choose_scale(const CoordinateRange& range, std::optional<double> scale,
                          std::span<const std::filesystem::path> files,
                          const PointReadOptions& how_to_read);

}  // namespace clearway
