#pragma once

#include "clearway/pose.hpp"

namespace clearway {

/// The map between those of two poses that moves each model point along its chord: every value is
/// linear in `part`, from a at 0 to b at 1. Where the poses turn, its matrix is not a rotation but
/// one that also shrinks.
inline Pose pose_on_chords(const Pose& a, const Pose& b, double part) {
  Pose out{};
  for (int k = 0; k < 9; ++k) {
    out.rotation[k] = a.rotation[k] + part * (b.rotation[k] - a.rotation[k]);
  }
  for (int k = 0; k < 3; ++k) {
    out.translation[k] = a.translation[k] + part * (b.translation[k] - a.translation[k]);
  }
  return out;
}

}  // namespace clearway
