#pragma once

#include <memory>

#include "io/scans/point_reader.hpp"

namespace clearway {

/// Multiplies the heights in a file's declarations by a factor. Integers stay as they are, because
/// scale and offset of z take the factor.
void convert_heights(CloudInfo& info, double factor);

/// A reader that delivers the points of another one with converted heights, in their order and
/// number.
std::shared_ptr<PointReader> with_converted_heights(std::shared_ptr<PointReader> reader,
                                                    double factor);

}  // namespace clearway
