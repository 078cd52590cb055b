#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace clearway {

/// Numbers of points by their class.
using ClassCounts = std::map<std::uint8_t, std::uint64_t>;

/// The ASPRS name of a class of points (LAS 1.4, point formats 6 to 10); "" for reserved and
/// user-defined classes.
const char* class_name(std::uint8_t value);

/// A class in words, such as "high noise (18)"; "class 64" where it has no name. Empty for the two
/// classes that say nothing of a point, never classified and unclassified.
std::string class_words(std::uint8_t value);

/// Adds the classes of some points.
void count_classes(std::span<const std::uint8_t> classes, ClassCounts& counts);

/// What points are classified as, the most frequent class first and at most three by name: "60 of
/// 60 points are classified as high noise (18)". points: number of all of them. Empty where no
/// class says anything.
std::string classified_words(const ClassCounts& counts, std::uint64_t points);

}  // namespace clearway
