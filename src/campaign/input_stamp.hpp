#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "campaign/plan.hpp"

namespace clearway::campaign {

/// Size and time of a file that a task reads. A state keeps them, so that whoever looks at a result
/// sees that it is of an earlier file, without reading the file.
struct InputStamp {
  std::string what;  ///< "model", "trajectory", "vehicle" or "environment"
  std::string file;
  std::uint64_t bytes = 0;
  std::int64_t modified = 0;  ///< nanoseconds, as the file system has them
  friend bool operator==(const InputStamp&, const InputStamp&) = default;
};

/// Of all files that the task's run reads, as they are now; of a vehicle also those that its file
/// names. Files that are missing are left out.
std::vector<InputStamp> stamps_of(const Task& task);

/// "the model file truck.ply changed since this run"; empty where no file did. A file that is
/// missing now has not been replaced, so it does not count.
std::string changed_since(const std::vector<InputStamp>& stamps);

}  // namespace clearway::campaign
