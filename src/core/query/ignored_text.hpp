#pragma once

#include <string>
#include <vector>

#include "clearway/ignored.hpp"
#include "clearway/query.hpp"

namespace clearway {

/// What a query leaves out: "classes 2, 7-9 and 1 box"; of one that leaves nothing out, "nothing".
std::string ignored_text(const QueryParameters& query);

/// The same with the number of points: "1,234 points ignored (class 2)".
std::string ignored_text(const QueryParameters& query, const IgnoredPointCounts& counts);

/// The corners: "1 2 3 to 4 5 6".
std::string box_text(const Box& box);

/// Of all, separated by semicolons; "none".
std::string boxes_text(const std::vector<Box>& boxes);

}  // namespace clearway
