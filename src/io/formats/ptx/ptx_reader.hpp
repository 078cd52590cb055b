#pragma once

#include <memory>
#include <vector>

#include "io/formats/input_buffer.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// Reads PTX: the scans one after the other, the matrix of each applied in double. A point 0 0 0 is
/// a beam without a return and absent. Remarks: scans and absent points, a matrix that is not
/// rigid, the scanner's axes where they contradict it. `remarks` come first. The input must be able
/// to seek.
std::unique_ptr<PointReader> read_ptx(InputBuffer input, std::vector<Message> remarks = {});

/// Reads the text that the count lines tell: PTX, or XYZ with or without a count, whatever its name
/// says. A remark says so where the name says otherwise. named_ptx: it does so by its ending.
std::unique_ptr<PointReader> read_scan_text(InputBuffer input, bool named_ptx,
                                            const PointReadOptions& options = {});

}  // namespace clearway
