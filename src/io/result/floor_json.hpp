#pragma once

#include "clearway/answer.hpp"
#include "io/files/json.hpp"

namespace clearway {

/// The floor of an answer, and how many points would collide below it; null without a floor. The
/// height is null where only bodies have floors.
inline Json floor_json(const Answer& answer) {
  if (!answer.floor_colliding) return nullptr;
  Json out{{"height", nullptr}, {"colliding", *answer.floor_colliding}};
  if (answer.parameters.floor) out["height"] = *answer.parameters.floor;
  return out;
}

}  // namespace clearway
