#pragma once

#include <string>

#include "search/checks/question.hpp"

/// Lengths and boxes as the warnings name them.
namespace clearway {

/// Three digits or more, and no digit after the decimal point from 1000 on: "0.0045", "12.3",
/// "4516203".
std::string figure(double value);

/// "m" or "ft".
std::string unit_name(LengthUnit unit);

/// "12.3 m".
std::string length_text(double length, LengthUnit unit);

/// "4.5 x 1.9 x 1.5 m".
std::string size_text(const Box& box, LengthUnit unit);

/// "x -65.7 to 140, y -79.8 to 92.6, z -16.3 to 5.18".
std::string extent_text(const Box& box);

/// "12 %"; "below 1 %" and "above 99 %" where the rounded figure would say none or all.
std::string share_text(double share);

}  // namespace clearway
