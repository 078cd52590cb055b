#pragma once

#include <memory>

#include "io/formats/input_buffer.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// Reads PCD: ascii, binary and binary_compressed. Points come in the frame of the file's x, y and
/// z. VIEWPOINT, where it is more than the default, is not applied and a remark says so: PCL
/// defines it as where the points were acquired from. In an organised cloud (HEIGHT above 1) a
/// point with NaN is absent. The input must be able to seek.
std::unique_ptr<PointReader> read_pcd(InputBuffer input);

}  // namespace clearway
