#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "campaign/task_list.hpp"

namespace clearway::campaign {

/// What the scripts of a campaign are made of.
struct SlurmJob {
  std::string name;
  std::filesystem::path program, folder;  ///< absolute
  std::size_t tasks = 0;
  TaskList merges;                 ///< of them, those that wait for their shards
  std::uint64_t memory_bytes = 0;  ///< of --memory
  int threads = 0;                 ///< 0: not said
  bool gpu = false;
  std::vector<std::string> options;  ///< of sbatch
};

/// campaign.sbatch: one element of the array is one task.
std::string sbatch_text(const SlurmJob& job);

/// submit.sh: submits all tasks, or those of a list, the merges after the shards, and the report
/// after all.
std::string submit_text(const SlurmJob& job);

}  // namespace clearway::campaign
