#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "campaign/plan.hpp"

namespace clearway::campaign {

/// Size and time of a file that a task reads. A task's state keeps them, so that anyone who looks
/// at a result can see that it belongs to an earlier file, without reading the file.
struct InputStamp {
  std::string what;  ///< "model", "trajectory", "vehicle" or "environment"
  std::string file;
  std::uint64_t bytes = 0;
  /// Time of the last modification in nanoseconds, as the file system counts it.
  std::int64_t modified = 0;
  friend bool operator==(const InputStamp&, const InputStamp&) = default;
};

/// Stamps of all files that the task's run reads, as they are now; for a vehicle also those of the
/// files that its file names. Missing files are left out.
std::vector<InputStamp> stamps_of(const Task& task);

/// Names the files that changed, for example "the model file truck.ply changed since this run";
/// empty where no file did. A missing file has not been replaced, so it does not count.
std::string changed_since(const std::vector<InputStamp>& stamps);

}  // namespace clearway::campaign
