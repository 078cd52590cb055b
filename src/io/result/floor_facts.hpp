#pragma once

#include <string>

#include "clearway/answer.hpp"
#include "io/files/json.hpp"

namespace clearway {

/// The floor of an answer, and how many points would collide below it; null without a floor.
/// `height` is that of the query, null where only bodies have floors, and `bodies` has the floor of
/// each body. With an error budget nothing is judged that is `lowered_by` below the floor.
Json floor_json(const Answer& answer);

/// Where a floor is, such as "0.25 m of the vehicle"; with several bodies that differ, the floor of
/// each. floor: from floor_json(), not null. unit: the symbol of lengths, "m".
std::string floor_words(const Json& floor, const std::string& unit);

}  // namespace clearway
