#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
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
  /// The unit of the file; that of the environment where it is not known.
  FileUnit unit = {};
  /// Length of the environment's unit in metres, to which corners are converted.
  double environment_unit = 1;
};

/// Reads the outline in a file of text: two numbers in each line, separated by a comma, a semicolon
/// or blanks, after one line of names, "y,z" or "height,half_width", which may be missing. A last
/// corner that equals the first is left out. Throws InputError, which names the line, for anything
/// else in the file, and for names that contradict the options. messages: where given, a warning is
/// appended for one half of an outline that is not mirrored ("half-outline").
std::vector<OutlinePoint> read_outline(const std::filesystem::path& path,
                                       const OutlineOptions& options = {},
                                       std::vector<Message>* messages = nullptr);

/// A row of a table of outlines: the load that is judged on a stretch of the path.
struct OutlineRow {
  std::uint64_t line = 0;           ///< line of the file
  double from = 0, to = 0;          ///< the stretch reaches up to `to`, without it
  std::filesystem::path file = {};  ///< of the outline
  std::vector<OutlinePoint> outline = {};
  std::optional<double> margin = {};  ///< the distance to keep; none where the row has none
};

/// Outlines by stretches of a path: dynamic envelopes, or gauges that are wider in curves.
struct OutlineTable {
  std::filesystem::path path = {};
  /// Whether stretches are given by stations along an alignment, in metres, and not by chainages
  /// along the path, in the unit of the environment.
  bool by_station = false;
  std::vector<OutlineRow> rows = {};  ///< ascending, and none overlaps the next one
};

/// The greatest number of rows of a table of outlines.
inline constexpr std::size_t kMostOutlineRows = 100'000;

/// Reads a table of outlines: CSV with a line of names, the columns chainage_from, chainage_to or
/// station_from, station_to, then outline and, where it is there, margin, in any order. The file of
/// an outline is relative to the folder of the table, and is read as read_outline() does. Throws
/// InputError, which names the line, for anything else in the file, for a stretch that ends before
/// it begins, and for rows that overlap.
OutlineTable read_outline_table(const std::filesystem::path& path,
                                const OutlineOptions& options = {},
                                std::vector<Message>* messages = nullptr);

}  // namespace clearway
