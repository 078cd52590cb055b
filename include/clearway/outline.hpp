#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "clearway/file_unit.hpp"
#include "clearway/model.hpp"
#include "clearway/progress.hpp"

/// Models that are made from a few numbers: boxes, and loads or gauges with one cross-section.
namespace clearway {

/// A corner of a cross-section in the model's frame: y to the left, z up.
struct OutlinePoint {
  double y, z;
  friend bool operator==(const OutlinePoint&, const OutlinePoint&) = default;
};

/// The greatest number of corners of an outline.
inline constexpr std::size_t kMostOutlinePoints = 10'000;

/// A closed box that stands on z = 0, with its middle over the origin: `length` along x, `width`
/// along y, `height` along z, in metres. Throws UsageError where one of them is not above 0 or not
/// finite.
Model box_model(double length, double width, double height);

/// A closed solid whose cross-section is the outline from x = rear to x = front, in metres. The
/// outline is a polygon without its first corner repeated at the end, in either sense of rotation.
/// For n corners the solid has 2 n vertices and 4 n - 4 triangles, whose normals point outwards.
/// Throws UsageError for a front that is not in front of the rear, for fewer than 3 or more than
/// kMostOutlinePoints corners, for coordinates that are not finite or beyond 1e6, for corners that
/// coincide, and for edges that cross or touch each other.
Model outline_model(std::span<const OutlinePoint> outline, double rear, double front);

/// How the file of an outline is read.
struct OutlineOptions {
  /// The file has one half of a symmetric outline, as rows of height and half the width from the
  /// one end to the other: it is completed by its mirror image. Otherwise its rows are y and z.
  bool mirror = false;
  /// The unit of the file; metres where it is not known.
  FileUnit unit = {};
};

/// Reads the outline in a file of text: two numbers in each line, separated by a comma, a semicolon
/// or blanks, after one line of names, "y,z" or "height,half_width", which may be missing. A last
/// corner that equals the first is left out. Throws InputError, which names the line, for anything
/// else in the file, and for names that contradict the options. messages: where given, a warning is
/// appended for one half of an outline that is not mirrored ("half-outline").
std::vector<OutlinePoint> read_outline(const std::filesystem::path& path,
                                       const OutlineOptions& options = {},
                                       std::vector<Message>* messages = nullptr);

}  // namespace clearway
