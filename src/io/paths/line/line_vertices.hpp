#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "clearway/file_unit.hpp"
#include "clearway/line.hpp"
#include "io/paths/remarks.hpp"

namespace clearway {

/// The greatest number of vertices of a line.
inline constexpr std::size_t kMostLineVertices = 1'000'000;

/// The vertices of a line as its file has them, in metres. Each list but x and y may be empty.
struct LineVertices {
  std::vector<double> x, y, z, station;
  std::vector<double> cant;  ///< how far the left rail is above the right one
  /// Where each vertex stands in the file: its line, or its index in a list of GeoJSON
  std::vector<std::uint64_t> place;
  std::string list;  ///< key of the list of GeoJSON; empty for a table
  const char* format = "csv";
  FileUnit unit = {};  ///< where the file or an option names it
  double metres_per_unit = 1;
  long epsg = 0;  ///< EPSG code of the coordinates; 0 where the file names none

  std::size_t size() const { return x.size(); }
  /// The place of a vertex in words: "line 4" or "coordinates[2]".
  std::string place_of(std::size_t vertex) const;
};

/// Reads a table or GeoJSON, by its first character. All numbers are finite and below 1e9 metres.
/// Vertices that stand twice in a row are left out with a note. Throws InputError.
LineVertices read_line_vertices(const std::filesystem::path& path, const LineOptions& options,
                                Remarks& out);

}  // namespace clearway
