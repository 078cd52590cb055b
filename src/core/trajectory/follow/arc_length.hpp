#pragma once

#include "core/trajectory/pose_spline.hpp"

namespace clearway {

/// Arc length in metres along the positions of the curve between the parameters `from` <= `to`.
/// Uses the Gauss-Legendre rule with eight places, on halves of halves until halving changes less
/// than 1e-12 of a metre, or 1e-15 of the length. A place where the curve stands still does no
/// harm.
double arc_length(const PositionCurve& curve, double from, double to);

/// The parameter in [0, 1] at which the arc length from the curve's start is `length` metres.
/// whole: the arc length from 0 to 1. Uses Newton's method inside an interval that only shrinks.
double parameter_at(const PositionCurve& curve, double length, double whole);

}  // namespace clearway
