#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "campaign/plan.hpp"

namespace clearway::campaign {

/// What the Slurm scripts of a campaign are made of.
struct SlurmJob {
  std::string name;
  std::filesystem::path program, folder;  ///< absolute paths
  std::size_t tasks = 0;
  /// The numbers of the tasks that are merges and wait for their shards.
  TaskList merges;
  std::uint64_t memory_bytes = 0;  ///< value of --memory, in bytes
  int threads = 0;                 ///< 0 where it is not given
  bool gpu = false;
  std::vector<std::string> options;  ///< options of sbatch
};

/// The text of campaign.sbatch, in which one element of the array is one task.
std::string sbatch_text(const SlurmJob& job);

/// The text of submit.sh, which submits all tasks, or those of a list, the merges after the shards,
/// and the report after all of them. An empty list submits nothing, not even the report.
std::string submit_text(const SlurmJob& job);

}  // namespace clearway::campaign
