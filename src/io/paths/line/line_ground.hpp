#pragma once

#include <string>

#include "clearway/line.hpp"
#include "core/trajectory/line/line_path.hpp"
#include "io/paths/line/line_file.hpp"
#include "io/paths/line/line_vertices.hpp"

namespace clearway {

/// Puts a path on the ground of the store that the options name: its height becomes the mean of the
/// ground under the left and the right wheels, and its cant their difference. The height that the
/// path has is taken as that of the line, if the vertices have heights. Returns the stretch on
/// which the ground is known. Throws InputError where it is missing for more than
/// kLongestGroundGap; UsageError for a line with cant.
Reach put_on_ground(const std::string& name, const LineVertices& line, const LineOptions& options,
                    LinePath& path, LineFile& out);

}  // namespace clearway
