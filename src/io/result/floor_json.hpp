#pragma once

#include "clearway/answer.hpp"
#include "io/files/json.hpp"

namespace clearway {

/// The floor of an answer, and how many points would collide below it; null without a floor. The
/// height is null where only bodies have floors. With an error budget near_height is that of near
/// points, below which nothing is judged.
inline Json floor_json(const Answer& answer) {
  if (!answer.floor_colliding) return nullptr;
  Json out{{"height", nullptr}, {"colliding", *answer.floor_colliding}};
  if (!answer.parameters.floor) return out;
  out["height"] = *answer.parameters.floor;
  if (answer.budget) out["near_height"] = *answer.parameters.floor - answer.budget->clear();
  return out;
}

}  // namespace clearway
