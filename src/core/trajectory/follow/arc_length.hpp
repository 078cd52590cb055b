#pragma once

#include "core/trajectory/pose_spline.hpp"

namespace clearway {

/// Metres along the positions of the curve between the parameters `from` <= `to`. By Gauss and
/// Legendre's rule with eight places, on halves of halves until halving changes less than 1e-12
/// of a metre, or 1e-15 of the length. A place where the curve stands still is no obstacle.
double arc_length(const PositionCurve& curve, double from, double to);

/// The parameter in [0, 1] at which the curve is `length` metres behind its start; `whole`: its
/// arc_length from 0 to 1. By Newton's method inside an interval that only shrinks.
double parameter_at(const PositionCurve& curve, double length, double whole);

}  // namespace clearway
