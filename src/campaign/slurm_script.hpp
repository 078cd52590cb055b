#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "campaign/plan.hpp"

namespace clearway::campaign {

/// What the Slurm scripts of a campaign are made of.
struct SlurmJob {
  std::filesystem::path program, folder;  ///< absolute paths
  std::uint64_t memory_bytes = 0;         ///< value of --memory, in bytes
  std::string threads;                    ///< empty where they are not given
  bool gpu = false;
  std::vector<std::string> options;  ///< options of sbatch
};

/// The text of campaign.sbatch, in which one element of the array is one task.
std::string sbatch_text(const SlurmJob& job, const Plan& plan);

/// The text of submit.sh, which submits all tasks, or those of a list, the merges after the shards,
/// and the report after all of them. An empty list submits nothing, not even the report.
std::string submit_text(const SlurmJob& job, const Plan& plan);

}  // namespace clearway::campaign
