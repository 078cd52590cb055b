#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/line.hpp"
#include "clearway/pose.hpp"
#include "io/paths/poses_along.hpp"

namespace clearway {

/// How the ground under a line was found.
struct GroundFinding {
  std::size_t places = 0;      ///< at which it was looked for, on each side
  std::size_t left = 0;        ///< places at which it was found under the left wheels
  std::size_t right = 0;       ///< under the right ones
  std::size_t risen = 0;       ///< places and sides at which what was found rose too steeply
  double longest_bridged = 0;  ///< longest gap that was bridged, metres
};

/// The poses along a line and how its file was understood.
struct LineFile : PosesAlong {
  std::string format;                   ///< "csv" or "geojson"
  std::size_t vertices = 0;             ///< of the line, without those that are repeated
  std::size_t arcs = 0;                 ///< vertices that were rounded
  double length = 0;                    ///< of the path in plan, metres
  double metres_per_unit = 1;           ///< of the coordinates in the file
  std::optional<GroundFinding> ground;  ///< only on the ground
};

/// Reads a line as read_line() does, with details of the file.
LineFile read_line_file(const std::filesystem::path& path, const LineOptions& options);

}  // namespace clearway
