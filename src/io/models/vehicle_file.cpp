#include "io/models/vehicle_file.hpp"

#include <tbb/task_arena.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <variant>

#include "clearway/body.hpp"
#include "clearway/error.hpp"
#include "clearway/vehicle.hpp"
#include "core/geometry/point_box.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {
namespace {

/// The length at a key: a number, or a text with a unit such as "10m".
double length_at(const KeyReader& key, double environment_unit) {
  const auto& value = key.value();
  if (value.is_number()) return value.get<double>();
  if (!value.is_string()) key.refuse(R"(expected a length, for example 10.5 or "10.5m")");
  if (const auto length = length_of(key.text())) return length->in_units_of(environment_unit);
  key.refuse("is \"" + key.text() + R"(", expected a length, for example 10.5 or "10.5m")");
}

BodyMount pivots_of(const KeyReader& key, double environment_unit) {
  const std::vector<KeyReader> both = key.elements();
  if (both.size() != 2) {
    key.refuse("expected two lengths, the front pivot and the rear one, for example [10, -10]");
  }
  const BodyPivots pivots{length_at(both[0], environment_unit),
                          length_at(both[1], environment_unit)};
  if (pivots.front == pivots.rear) key.refuse("expected two different places");
  return pivots;
}

FileUnit unit_of(const KeyReader& key) {
  const std::string name = key.text();
  if (const auto unit = file_unit_of(name)) return *unit;
  key.refuse("is \"" + name + "\", expected " + file_unit_list());
}

std::string name_of(const KeyReader& key, std::set<std::string>& names) {
  std::string name = key.text();
  const bool control = std::ranges::any_of(
      name, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 0x7f; });
  if (control || name.size() > kMostNameBytes) {
    key.refuse("expected at most 100 bytes without control characters");
  }
  if (!names.insert(name).second) key.refuse("\"" + name + "\" names another body too");
  return name;
}

void set_motion(const KeyReader& body, const std::filesystem::path& folder, double environment_unit,
                BodyEntry& entry) {
  const bool has_at = body.has("at"), has_pivots = body.has("pivots");
  if (has_at + has_pivots + body.has("trajectory") > 1) {
    body.refuse("a body moves in one way: expected one of at, pivots and trajectory, or none");
  }
  if (has_at) entry.mount = BodyStation{length_at(body.at("at"), environment_unit)};
  if (has_pivots) entry.mount = pivots_of(body.at("pivots"), environment_unit);
  if (body.has("trajectory")) entry.trajectory = folder / body.at("trajectory").text();
}

}  // namespace

std::vector<BodyEntry> read_vehicle_file(const std::filesystem::path& path,
                                         double environment_unit) {
  const KeyReader file = KeyReader::parse(path, text_of_file(path));
  file.allow({"bodies"});
  const std::vector<KeyReader> bodies = file.at("bodies").elements(kMostBodies);
  std::vector<BodyEntry> entries;
  std::set<std::string> names;
  const std::filesystem::path folder = path.parent_path();
  for (const KeyReader& body : bodies) {
    body.allow({"name", "model", "model_unit", "at", "pivots", "trajectory"});
    BodyEntry entry{.at = body,
                    .name = name_of(body.at("name"), names),
                    .model = folder / body.at("model").text(),
                    .trajectory = {}};
    if (body.has("model_unit")) entry.model_unit = unit_of(body.at("model_unit"));
    set_motion(body, folder, environment_unit, entry);
    entries.push_back(std::move(entry));
  }
  return entries;
}

namespace {

/// Reads the files of bodies. Errors name the key of the body.
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

  /// Numbers the poses of a body that has all poses of the path.
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

  /// The stations of the path, computed once when the first body without a trajectory of its own
  /// needs them.
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

/// The stretch that a body occupies, in metres ahead of the path's pose.
struct Stretch {
  double from, to;

  double gap_to(const Stretch& other) const {
    return std::max({from - other.to, other.from - to, 0.0});
  }
  void add(const Stretch& other) {
    from = std::min(from, other.from);
    to = std::max(to, other.to);
  }
};

/// A body that follows the path, placed on a straight path.
struct MountedBody {
  const BodyEntry& entry;
  Stretch body, pivots;
};

double horizontal_length(const Box& box) {
  return std::max(box.hi.x - box.lo.x, box.hi.y - box.lo.y);
}

/// A body is far from the vehicle where this many times the longest body fits in between.
constexpr double kFarLengths = 3;

void warn_far(const std::filesystem::path& file, const MountedBody& one, const std::string& what,
              double gap, double longest, std::vector<Message>& warnings) {
  warnings.push_back(
      {Message::Severity::kWarning,
       "body-far",
       file.string() + ": " + one.entry.at.key() + " (" + one.entry.name + "): " + what + " " +
           format_brief(gap) + " m away, and the longest body of the vehicle has " +
           format_brief(longest) +
           " m. Stations and pivots are metres ahead of the path's pose, negative ones behind: "
           "check their sign and their unit",
       {{"gap", gap}, {"length", longest}}});
}

/// Warns of bodies that are far from the others, as with mistyped stations or pivots. Such a body
/// is moved along a path that it does not drive, and hardly anything near its true path is
/// searched.
void warn_of_far_bodies(const std::filesystem::path& file, const std::vector<BodyEntry>& entries,
                        const std::vector<Body>& bodies, std::vector<Message>& warnings) {
  std::vector<MountedBody> apart;
  double longest = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].model.empty() || !entries[i].trajectory.empty()) continue;
    const Box box = box_of(bodies[i].model.vertices);
    longest = std::max(longest, horizontal_length(box));
    const auto* station = std::get_if<BodyStation>(&entries[i].mount);
    const double at = station != nullptr ? station->at : 0;
    MountedBody one{entries[i], {at + box.lo.x, at + box.hi.x}, {at, at}};
    if (const auto* pivots = std::get_if<BodyPivots>(&entries[i].mount)) {
      one.pivots = {std::min(pivots->front, pivots->rear), std::max(pivots->front, pivots->rear)};
    }
    apart.push_back(one);
  }
  const double far = kFarLengths * longest;
  if (!(far > 0)) return;
  for (const MountedBody& one : apart) {
    if (std::holds_alternative<BodyPivots>(one.entry.mount) && one.body.gap_to(one.pivots) > far) {
      warn_far(file, one, "the pivots and the model are", one.body.gap_to(one.pivots), longest,
               warnings);
    }
  }
  // The vehicle grows from the path's pose, as a train does wagon by wagon.
  Stretch vehicle{0, 0};
  const auto near = [&](const MountedBody& one) { return vehicle.gap_to(one.body) <= far; };
  for (auto next = std::ranges::find_if(apart, near); next != apart.end();
       next = std::ranges::find_if(apart, near)) {
    vehicle.add(next->body);
    std::vector<MountedBody> rest;
    for (auto one = apart.begin(); one != apart.end(); ++one) {
      if (one != next) rest.push_back(*one);
    }
    apart.swap(rest);
  }
  for (const MountedBody& one : apart) {
    warn_far(file, one, "the path's pose and the nearest other body are", vehicle.gap_to(one.body),
             longest, warnings);
  }
}

}  // namespace

std::vector<Body> read_vehicle(const std::filesystem::path& file, const std::vector<Pose>& path,
                               const VehicleOptions& options, std::vector<Message>* warnings) {
  VehicleReader reader(file, path, options, warnings);
  std::vector<Body> bodies;
  const std::vector<BodyEntry> entries = read_vehicle_file(file, options.model.environment_unit);
  for (const BodyEntry& entry : entries) bodies.push_back(reader.read(entry));
  if (warnings != nullptr) warn_of_far_bodies(file, entries, bodies, *warnings);
  return bodies;
}

}  // namespace clearway
