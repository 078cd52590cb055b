#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "campaign/plan.hpp"
#include "cli/campaign/task_queue.hpp"
#include "cli/run_options.hpp"
#include "io/result/result.hpp"

namespace clearway::tool {

/// Reads the inputs of a campaign's runs as their tasks will, each environment, model and
/// trajectory once. Errors name the key of campaign.json that they come from.
class QuestionReader {
 public:
  /// shard_seconds: as in Campaign.
  QuestionReader(std::filesystem::path campaign_file, double shard_seconds)
      : file_(std::move(campaign_file)), estimate_(shard_seconds) {}

  /// Throws InputError, and ResourceError where an input cannot be read.
  campaign::RunFacts facts_of(const campaign::PlannedRun& run);

 private:
  struct Environment {
    ResultHeader header;           ///< the fields that describe the store
    double metres = 1;             ///< metres per unit of the store's coordinates
    bool unit_is_assumed = false;  ///< whether the store names no unit
    std::string unit, fingerprint;
  };
  struct ReadModel {
    std::uint64_t count = 0, triangles = 0, hash = 0;
    Box box{};
  };
  struct ReadTrajectory {
    std::uint64_t count = 0, hash = 0;
    std::vector<Pose> poses{};  ///< kept only where they are needed again
  };

  void parse(const campaign::PlannedRun& run, RunOptions& options) const;
  void check_outputs(const campaign::PlannedRun& run);
  void check_classes(const campaign::PlannedRun& run, const RunOptions& options,
                     double metres) const;
  const Environment& environment(const campaign::Entry& entry);
  const ReadModel& model(const campaign::PlannedRun& run, const RunOptions& options);
  const ReadTrajectory& trajectory(const campaign::PlannedRun& run, const RunOptions& options);
  std::uint32_t add_model(const campaign::PlannedRun& run, const RunOptions& options,
                          const ReadTrajectory& path, ResultHeader& header);
  std::uint32_t add_bodies(const campaign::PlannedRun& run, const RunOptions& options,
                           const ReadTrajectory& path, ResultHeader& header);

  template <typename Call>
  decltype(auto) named(const std::string& key, const Call& call) const;

  std::filesystem::path file_;
  std::map<std::string, Environment> environments_;
  std::map<std::string, ReadModel> models_;
  std::map<std::string, ReadTrajectory> trajectories_;
  RunEstimate estimate_;
  std::set<std::string> checked_;
};

}  // namespace clearway::tool
