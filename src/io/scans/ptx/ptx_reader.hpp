#pragma once

#include <memory>
#include <vector>

#include "io/scans/input_buffer.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// Reads PTX: the scans one after the other, the matrix of each applied in double precision. A
/// point 0 0 0 is a beam without a return and thus absent. There are remarks on a matrix that is
/// not rigid, and on the scanner's axes where they contradict the matrix. `remarks` come before
/// these. The input must be able to seek.
std::unique_ptr<PointReader> read_ptx(InputBuffer input, std::vector<Message> remarks = {});

/// Reads PTX, or XYZ with or without a count. The count lines decide which it is, whatever the
/// file's name says, and a remark mentions a name that says otherwise. named_ptx: whether the
/// name's ending is that of PTX.
std::unique_ptr<PointReader> read_scan_text(InputBuffer input, bool named_ptx,
                                            const PointReadOptions& options = {});

}  // namespace clearway
