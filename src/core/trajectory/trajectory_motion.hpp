#pragma once

#include <span>

#include "clearway/pose.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// displacement_bound() in metres, but 0 for equal poses, whose model points coincide exactly.
double motion_bound(const Box& model, const Pose& a, const Pose& b);

/// The greatest motion_bound() of two consecutive poses, metres; 0 for fewer than two poses.
double largest_motion(const Box& model, std::span<const Pose> poses);

}  // namespace clearway
