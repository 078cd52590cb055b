#pragma once

#include <string>
#include <vector>

#include "clearway/ignored.hpp"
#include "clearway/query.hpp"

namespace clearway {

/// What a query leaves out, such as "classes 2, 7-9 and 1 box"; "nothing" if it leaves nothing out.
std::string ignored_text(const QueryParameters& query);

/// What a query leaves out with the number of points, such as "1,234 points ignored (class 2)".
std::string ignored_text(const QueryParameters& query, const IgnoredPointCounts& counts);

/// The two corners of a box, such as "1 2 3 to 4 5 6".
std::string box_text(const Box& box);

/// All boxes, separated by semicolons; "none" if there are none.
std::string boxes_text(const std::vector<Box>& boxes);

}  // namespace clearway
