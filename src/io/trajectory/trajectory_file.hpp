#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/trajectory.hpp"
#include "core/trajectory/trajectory_doubts.hpp"

namespace clearway {

/// What a file holds and how it was understood.
struct TrajectoryFile {
  std::vector<Pose> poses;
  std::vector<double> times;       ///< seconds, one a pose; empty where the file has none
  std::vector<std::string> names;  ///< likewise
  TrajectoryFormat format = TrajectoryFormat::kAuto;
  std::string crs;             ///< that latitudes and longitudes were turned into, or empty
  double metres_per_unit = 1;  ///< of the positions, 1 but for a CRS in another unit
  bool in_metres = false;      ///< surely, as a unit was declared or the format has one
  FileUnit unit = {};  ///< of the positions in the file, where a header or an option names it
  RotationSource rotations = RotationSource::kMatrices;
  std::vector<Message> remarks;  ///< notes and warnings

  void note(const char* code, std::string text,
            std::vector<std::pair<std::string, double>> numbers = {}) {
    remarks.push_back({Message::Severity::kNote, code, std::move(text), std::move(numbers)});
  }
  void warn(const char* code, std::string text,
            std::vector<std::pair<std::string, double>> numbers = {}) {
    remarks.push_back({Message::Severity::kWarning, code, std::move(text), std::move(numbers)});
  }
};

/// As read_trajectory.
TrajectoryFile read_trajectory_file(const std::filesystem::path& path,
                                    const TrajectoryOptions& options);

/// "matrix", "tum", ...: the names that the command line has for them.
const char* name_of(TrajectoryFormat format);

}  // namespace clearway
