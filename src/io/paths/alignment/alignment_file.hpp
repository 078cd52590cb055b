#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "clearway/alignment.hpp"
#include "clearway/pose.hpp"
#include "io/paths/poses_along.hpp"

namespace clearway {

/// The poses along an alignment and how its file was understood.
struct AlignmentFile : PosesAlong {
  std::string alignment, profile;  ///< names of what was read; profile is empty where there is none
  std::string unit;                ///< unit of the file, as LandXML names it
  double metres_per_unit = 1;
  double first_station = 0, last_station = 0;  ///< of the alignment's plan, metres
};

/// Reads an alignment as read_alignment() does, with details of the file.
AlignmentFile read_alignment_file(const std::filesystem::path& path,
                                  const AlignmentOptions& options);

}  // namespace clearway
