#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/box.hpp"

/// Random parts of small scenes. Every test seeds its own generator.
namespace clearway {

using Random = std::mt19937_64;

double uniform(Random& random, double lo, double hi);
std::uint64_t below(Random& random, std::uint64_t end);
Vec3 random_point(Random& random, const Box& box);
std::vector<Vec3> random_points(Random& random, const Box& box, std::size_t count);
Vec3 random_direction(Random& random);

/// The pose that rotates by `angle` (radians) about a unit axis and then translates.
Pose rotation(const Vec3& axis, double angle, const Vec3& translation);
Pose random_rotation(Random& random, const Vec3& translation);
Pose translation(const Vec3& by);

/// The pose as a text file with six decimals holds it: slightly non-orthonormal.
Pose printed_with_six_digits(Pose pose);

/// The pose with the columns of its rotation scaled by `by`.
Pose stretched(Pose pose, const Vec3& by);

/// Changes of a whole path: what a text file with six decimals holds of it; columns of its
/// rotations scaled; the way back behind it; one pose inserted `times` more; each pose `times`
/// times.
void print_with_six_digits(std::vector<Pose>& poses);
void stretch(std::vector<Pose>& poses, const Vec3& by);
void drive_back(std::vector<Pose>& poses);
void stop_at(std::vector<Pose>& poses, std::ptrdiff_t pose, std::size_t times);
void repeat_each(std::vector<Pose>& poses, std::size_t times);

/// A smooth path through the box that turns as it goes.
std::vector<Pose> smooth_path(Random& random, const Box& box, std::size_t count);

/// A path of 5 m along x that moves to the left along a parabola, by 0.5 bend metres, and turns by
/// bend radians.
std::vector<Pose> slow_path(int count, double bend);

/// A path of small steps, on which what was proven at one pose holds at many more: straight on,
/// bent, turning about any place, to and fro, rolling, climbing, trembling, with stops and jumps.
std::vector<Pose> random_slow_path(Random& random, std::size_t count);

}  // namespace clearway
