#pragma once

#include <span>
#include <vector>

#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// Warnings on axes along which all samples are multiples of a coarse step, a power of ten or of
/// two. The digits below it were lost, by rounding in text or by single floats far from the origin.
std::vector<Message> warn_of_lost_digits(std::span<const Vec3> samples);

}  // namespace clearway
