#include "core/query/ignored_text.hpp"

#include "core/util/format.hpp"
#include "core/util/number_ranges.hpp"

namespace clearway {

std::string ignored_text(const QueryParameters& query) {
  std::string text;
  if (!query.ignore_classes.empty()) {
    text = query.ignore_classes.size() == 1 ? "class " : "classes ";
    bool first = true;
    for (const std::string& range : number_ranges(query.ignore_classes)) {
      text += (first ? "" : ", ") + range;
      first = false;
    }
  }
  if (!query.ignore_boxes.empty()) {
    text += (text.empty() ? "" : " and ") + counted(query.ignore_boxes.size(), "box", "boxes");
  }
  return text.empty() ? "nothing" : text;
}

std::string ignored_text(const QueryParameters& query, const IgnoredPointCounts& counts) {
  return counted(counts.points, "point") + " ignored (" + ignored_text(query) + ")";
}

std::string box_text(const Box& box) {
  const auto corner_text = [](const Vec3& corner) {
    return format_number(corner.x) + " " + format_number(corner.y) + " " + format_number(corner.z);
  };
  return corner_text(box.lo) + " to " + corner_text(box.hi);
}

std::string boxes_text(const std::vector<Box>& boxes) {
  std::string text;
  for (const Box& box : boxes) text += (text.empty() ? "" : "; ") + box_text(box);
  return text.empty() ? "none" : text;
}

}  // namespace clearway
