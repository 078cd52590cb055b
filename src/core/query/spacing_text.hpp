#pragma once

#include <string>

namespace clearway {

/// Text that accompanies an answer that no point is closer than the radius, because a search of
/// points can miss what is closer to the surface: "; the model is points of a mesh, and no place of
/// its surface is farther than 0.025 m from one, so the surface may come as close as 0.075 m".
/// Empty if the spacing is 0. unit: unit of both lengths.
std::string spacing_text(double spacing, double radius, const std::string& unit);

}  // namespace clearway
