#pragma once

#include <string>

#include "search/checks/question.hpp"

/// Lengths and boxes as the warnings name them.
namespace clearway {

/// A number as the warnings show it, with three digits or more, and none after the decimal point
/// from 1000 on: "0.0045", "12.3", "4516203".
std::string figure(double value);

/// The symbol of a unit of length: "m" or "ft".
std::string unit_name(LengthUnit unit);

/// A length with its unit, for example "12.3 m".
std::string length_text(double length, LengthUnit unit);

/// The side lengths of a box with their unit, for example "4.5 x 1.9 x 1.5 m".
std::string size_text(const Box& box, LengthUnit unit);

/// The range of a box on each axis, for example "x -65.7 to 140, y -79.8 to 92.6, z -16.3 to 5.18".
std::string extent_text(const Box& box);

/// A share in percent, for example "12 %"; "below 1 %" and "above 99 %" where the rounded figure
/// would say none or all.
std::string share_text(double share);

}  // namespace clearway
