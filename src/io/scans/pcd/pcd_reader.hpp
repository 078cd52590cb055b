#pragma once

#include <memory>

#include "io/scans/input_buffer.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// Reads PCD files with ascii, binary and binary_compressed data. Points are in the frame of the
/// file's x, y and z. A VIEWPOINT other than the default is not applied, because PCL defines it as
/// where the points were acquired from, and a remark says so. In an organised cloud (HEIGHT above
/// 1) a point with NaN is absent. The input must be able to seek.
std::unique_ptr<PointReader> read_pcd(InputBuffer input);

}  // namespace clearway
