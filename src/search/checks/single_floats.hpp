#pragma once

#include <optional>
#include <span>
#include <string>

#include "clearway/vec3.hpp"
#include "core/messages/messages.hpp"
#include "search/checks/question.hpp"

namespace clearway {

/// The largest step between neighbouring numbers of single precision at the coordinates of these
/// places, if the places went through single precision; nothing otherwise. Only coordinates at
/// which that step is above `least` are judged. Coordinates that are all whole centimetres, or
/// whole hundredths of the places' own unit, are those of rounded text, and not judged either.
/// metre: the length of a metre in the unit of the places.
std::optional<double> single_precision_step(std::span<const Vec3> places, double least,
                                            double metre);

/// Warns where the places went through single precision and its steps matter beside the radius:
/// "single-precision". whose: what the places are, such as "the positions of the path"; remedy: a
/// sentence without its full stop.
void warn_of_single_precision(const Question& question, std::span<const Vec3> places,
                              const std::string& whose, const std::string& remedy, MessageLog& log);

}  // namespace clearway
