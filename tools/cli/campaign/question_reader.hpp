#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "campaign/plan.hpp"
#include "clearway/box.hpp"
#include "clearway/pose.hpp"
#include "clearway/store.hpp"
#include "cli/run_options.hpp"
#include "io/result/result.hpp"

namespace clearway::tool {

/// Reads the inputs of a campaign's runs as their tasks will, each environment, model and
/// trajectory once. Errors name the key of campaign.json that they come from.
class QuestionReader {
 public:
  /// shard_seconds: the time that one shard is to take, by estimate; 0 divides no run.
  QuestionReader(std::filesystem::path campaign_file, double shard_seconds)
      : file_(std::move(campaign_file)), shard_seconds_(shard_seconds) {}

  /// Throws InputError, and ResourceError where an input cannot be read.
  campaign::RunFacts facts_of(const campaign::PlannedRun& run);

 private:
  struct Environment {
    ResultHeader header;           ///< the fields that describe the store
    double metres = 1;             ///< metres per unit of the store's coordinates
    bool unit_is_assumed = false;  ///< whether the store names no unit
    std::string unit, fingerprint;
  };
  /// A model, or the bodies of a vehicle.
  struct ReadModel {
    struct Part {
      std::uint64_t points = 0, triangles = 0;
      Box box{};
      std::span<const Pose> poses;
    };
    std::vector<Part> parts;
    std::uint64_t hash = 0;
    ModelAxes axes;
    std::vector<Body> bodies;  ///< hold the poses of the parts of a vehicle
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
  ReadModel model(const campaign::PlannedRun& run, const RunOptions& options);
  ReadModel vehicle(const campaign::PlannedRun& run, const RunOptions& options,
                    const std::vector<Pose>& poses) const;
  const ReadTrajectory& trajectory(const campaign::PlannedRun& run, const RunOptions& options);
  std::uint32_t shards_of(const RunOptions& run, const ReadModel& model);

  template <typename Call>
  decltype(auto) named(const std::string& key, const Call& call) const;

  std::filesystem::path file_;
  double shard_seconds_;
  std::map<std::string, Environment> environments_;
  std::map<std::string, ReadModel> models_;
  std::map<std::string, ReadTrajectory> trajectories_;
  std::optional<Store> store_;     ///< that of the last run that was estimated
  std::set<std::string> checked_;  ///< the commands of outputs that were checked
};

}  // namespace clearway::tool
