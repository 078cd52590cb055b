#include "core/query/spacing_text.hpp"

#include "core/util/format.hpp"

namespace clearway {

std::string spacing_text(double spacing, double radius, const std::string& unit) {
  if (!(spacing > 0)) return "";
  const std::string closest =
      spacing < radius ? "come as close as " + format_brief(radius - spacing) + " " + unit
                       : std::string("touch something");
  return "; the model is points of a mesh, and no place of its surface is farther than " +
         format_brief(spacing) + " " + unit + " from one, so the surface may " + closest;
}

}  // namespace clearway
