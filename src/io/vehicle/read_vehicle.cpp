#include <tbb/task_arena.h>

#include <numeric>
#include <optional>
#include <variant>

#include "clearway/error.hpp"
#include "clearway/vehicle.hpp"
#include "core/util/format.hpp"
#include "io/vehicle/vehicle_file.hpp"

namespace clearway {
namespace {

/// Reads the files of bodies; what goes wrong with them names the key.
class VehicleReader {
  template <typename Call>
  decltype(auto) named(const KeyReader& key, const Call& call) {
    const auto where = [&](const Error& error) {
      return file_.string() + ": " + key.key() + ": " + error.what();
    };
    try {
      return call();
    } catch (const InputError& error) {
      throw InputError(where(error), error.remedy(), error.amount());
    } catch (const UsageError& error) {
      throw UsageError(where(error), error.remedy(), error.amount());
    } catch (const ResourceError& error) {
      throw ResourceError(where(error), error.remedy(), error.amount());
    }
  }

 public:
  VehicleReader(const std::filesystem::path& file, const std::vector<Pose>& path,
                const VehicleOptions& options, std::vector<Message>* warnings)
      : file_(file),
        path_(path),
        options_(options),
        threads_(options.threads > 0 ? options.threads : tbb::this_task_arena::max_concurrency()),
        warnings_(warnings) {}

  Body read(const BodyEntry& entry) {
    Body body{.name = entry.name, .model = {}, .poses = {}, .path_pose = {}};
    ModelOptions how = options_.model;
    if (entry.model_unit.is_known()) how.unit = entry.model_unit;
    body.model =
        named(entry.at.at("model"), [&] { return read_model(entry.model, how, warnings_); });
    const auto* station = std::get_if<BodyStation>(&entry.mount);
    if (!entry.trajectory.empty()) {
      read_own(entry, body);
    } else if (station != nullptr && station->at == 0) {
      body.poses = path_;
      number_poses(body);
    } else {
      follow(entry, body);
    }
    return body;
  }

 private:
  void read_own(const BodyEntry& entry, Body& body) {
    const KeyReader key = entry.at.at("trajectory");
    body.poses = named(
        key, [&] { return read_trajectory(entry.trajectory, options_.trajectory, warnings_); });
    if (body.poses.size() != path_.size()) {
      key.refuse(entry.trajectory.string() + " has " + counted(body.poses.size(), "pose") +
                 ", expected as many as the path: " + format_count(path_.size()));
    }
    number_poses(body);
  }

  /// It has all of them.
  static void number_poses(Body& body) {
    body.path_pose.resize(body.poses.size());
    std::iota(body.path_pose.begin(), body.path_pose.end(), 0);
  }

  void follow(const BodyEntry& entry, Body& body) {
    const PathStations& path = named(entry.at, [&]() -> const PathStations& { return stations(); });
    FollowedPath followed =
        named(entry.at, [&] { return follow_path(path, entry.mount, threads_); });
    const std::string name = file_.string() + ": " + entry.at.key() + " (" + entry.name + ")";
    if (warnings_ != nullptr) {
      for (Message& doubt : doubts_about(followed, path, entry.mount, name)) {
        warnings_->push_back(std::move(doubt));
      }
    }
    if (followed.poses.empty() && !path_.empty()) {
      entry.at.refuse("the path is " + format_brief(path.length()) +
                      " m long, and the body has a pose nowhere on it; expected a longer path, or "
                      "stations nearer to its poses");
    }
    body.poses = std::move(followed.poses);
    body.path_pose.assign(followed.of.begin(), followed.of.end());
  }

  /// Once for all bodies, and not for those with trajectories of their own.
  const PathStations& stations() {
    if (!stations_) stations_.emplace(path_, threads_);
    return *stations_;
  }

  const std::filesystem::path& file_;
  const std::vector<Pose>& path_;
  const VehicleOptions& options_;
  int threads_;
  std::vector<Message>* warnings_;
  std::optional<PathStations> stations_;
};

}  // namespace

std::vector<Body> read_vehicle(const std::filesystem::path& file, const std::vector<Pose>& path,
                               const VehicleOptions& options, std::vector<Message>* warnings) {
  VehicleReader reader(file, path, options, warnings);
  std::vector<Body> bodies;
  for (const BodyEntry& entry : read_vehicle_file(file, options.model.environment_unit)) {
    bodies.push_back(reader.read(entry));
  }
  return bodies;
}

}  // namespace clearway
