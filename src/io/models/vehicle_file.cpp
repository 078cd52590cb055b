#include "io/models/vehicle_file.hpp"

#include <algorithm>
#include <cmath>
#include <list>
#include <numeric>
#include <optional>
#include <set>
#include <variant>

#include "clearway/body.hpp"
#include "clearway/error.hpp"
#include "clearway/vehicle.hpp"
#include "core/geometry/point_box.hpp"
#include "core/trajectory/follow/towed.hpp"
#include "core/util/format.hpp"
#include "io/files/text_number.hpp"
#include "io/files/thread_limit.hpp"
#include "io/models/model_input.hpp"
#include "io/scans/formatted_message.hpp"
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

/// A place on a body's x axis, where a hitch or an axle may be.
double hitch_at(const KeyReader& key, double environment_unit) {
  const double x = length_at(key, environment_unit);
  if (!(std::abs(x) <= kFarthestHitch)) key.refuse("expected at most 1000 km from the origin");
  return x;
}

BodyMount towed_of(const KeyReader& key, double environment_unit) {
  key.allow({"by", "at", "pivots"});
  const KeyReader both = key.at("pivots");
  const std::vector<KeyReader> pivots = both.elements();
  if (pivots.size() != 2) {
    both.refuse("expected two lengths, the hitch and the axle, for example [9.2, 1.4]");
  }
  const BodyTowed towed{.by = key.has("by") ? key.at("by").text() : "",
                        .at = hitch_at(key.at("at"), environment_unit),
                        .hitch = hitch_at(pivots[0], environment_unit),
                        .axle = hitch_at(pivots[1], environment_unit)};
  if (!(towed.hitch > towed.axle)) {
    both.refuse("expected the hitch, which comes first, ahead of the axle, for example [9.2, 1.4]");
  }
  return towed;
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
  const bool has_towed = body.has("towed"), has_trajectory = body.has("trajectory");
  if (has_at + has_pivots + has_towed + has_trajectory > 1) {
    body.refuse(
        "a body moves in one way: expected one of at, pivots, towed and trajectory, or none");
  }
  if (has_at) entry.mount = BodyStation{length_at(body.at("at"), environment_unit)};
  if (has_pivots) entry.mount = pivots_of(body.at("pivots"), environment_unit);
  if (has_towed) entry.mount = towed_of(body.at("towed"), environment_unit);
  if (!has_trajectory) return;
  entry.mount = BodyOwnPoses{};
  entry.trajectory = folder / body.at("trajectory").text();
}

/// Which body of the file tows which.
Towing towing_of(const std::vector<BodyEntry>& entries) {
  std::vector<std::string> names;
  std::vector<BodyMount> mounts;
  for (const BodyEntry& entry : entries) {
    names.push_back(entry.name);
    mounts.push_back(entry.mount);
  }
  return clearway::towing_of(names, mounts);
}

}  // namespace

std::vector<std::filesystem::path> BodyEntry::files() const {
  std::vector<std::filesystem::path> out;
  if (!names_box(model)) out.push_back(model);
  if (!trajectory.empty()) out.push_back(trajectory);
  return out;
}

std::vector<BodyEntry> read_vehicle_file(const std::filesystem::path& path,
                                         double environment_unit) {
  const KeyReader file = KeyReader::parse(path, text_of_file(path));
  file.allow({"bodies"});
  const std::vector<KeyReader> bodies = file.at("bodies").elements(kMostBodies);
  std::vector<BodyEntry> entries;
  std::set<std::string> names;
  const std::filesystem::path folder = path.parent_path();
  for (const KeyReader& body : bodies) {
    body.allow({"name", "model", "model_unit", "at", "pivots", "towed", "trajectory", "floor"});
    const std::string model = body.at("model").text();
    BodyEntry entry{.at = body,
                    .name = name_of(body.at("name"), names),
                    .model = names_box(model) ? std::filesystem::path(model) : folder / model,
                    .trajectory = {}};
    if (body.has("model_unit")) entry.model_unit = unit_of(body.at("model_unit"));
    if (body.has("floor")) entry.floor = length_at(body.at("floor"), environment_unit);
    set_motion(body, folder, environment_unit, entry);
    entries.push_back(std::move(entry));
  }
  if (const auto fault = towing_of(entries).fault) {
    entries[fault->body].at.at("towed").at("by").refuse(fault->what);
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
                const VehicleOptions& options, std::vector<Message>* warnings,
                FollowedPath* last = nullptr)
      : file_(file),
        path_(path),
        options_(options),
        threads_(threads_or_all(options.threads)),
        warnings_(warnings),
        last_(last) {
    check_threads(threads_);
  }

  Model read_model_of(const BodyEntry& entry) {
    ModelOptions how = options_.model;
    if (entry.model_unit.is_known()) how.unit = entry.model_unit;
    std::vector<Message> messages;
    Model model =
        named(entry.at.at("model"), [&] { return read_model(entry.model, how, &messages); });
    if (warnings_ == nullptr) return model;
    for (Message& message : messages) {
      message.body = entry.name;
      warnings_->push_back(std::move(message));
    }
    return model;
  }

  /// Gives a body that is not towed its poses.
  void place(const BodyEntry& entry, Body& body) {
    const auto* station = std::get_if<BodyStation>(&entry.mount);
    if (!entry.trajectory.empty()) {
      read_own(entry, body);
    } else if (station != nullptr && station->at == 0) {
      body.poses = path_;
      number_poses(body);
    } else {
      take(entry,
           named(entry.at, [&] { return follow_path(stations(entry), entry.mount, threads_); }),
           body);
    }
  }

  /// Gives the towed bodies their poses. bodies: one for each entry, of which those that are not
  /// towed have theirs.
  void place_towed(const std::vector<BodyEntry>& entries, const Towing& towing,
                   std::vector<Body>& bodies) {
    if (towing.order.empty()) return;
    std::vector<MountedBody> mounted;
    for (const BodyEntry& entry : entries) {
      mounted.push_back({entry.mount, &stations(entries[towing.order.front()]), {}});
    }
    std::list<PathStations> own;
    for (const auto& tower : towing.tower) {
      if (!tower || entries[*tower].trajectory.empty()) continue;
      named(entries[*tower].at.at("trajectory"),
            [&] { own.emplace_back(bodies[*tower].poses, threads_); });
      mounted[*tower].path = &own.back();
    }
    const BodyEntry& first = entries[towing.order.front()];
    std::vector<FollowedPath> followed = named(first.at.at("towed"), [&] {
      return follow_towed(mounted, towing, options_.model.environment_unit, threads_);
    });
    for (const std::size_t i : towing.order) take(entries[i], std::move(followed[i]), bodies[i]);
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

  /// Gives a body the poses that were found for it.
  void take(const BodyEntry& entry, FollowedPath followed, Body& body) {
    const PathStations& path = stations(entry);
    if (followed.pushed_from) entry.at.at("towed").refuse(pushed_text(followed, path));
    const std::string name = file_.string() + ": " + entry.at.key() + " (" + entry.name + ")";
    if (warnings_ != nullptr) {
      for (Message& doubt : doubts_about(followed, path, entry.mount, name)) {
        doubt.body = entry.name;
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
    if (last_ != nullptr) *last_ = std::move(followed);
  }

  /// The stations of the path, computed once when the first body without a trajectory of its own
  /// needs them, which an error names.
  const PathStations& stations(const BodyEntry& entry) {
    if (!stations_) named(entry.at, [&] { stations_.emplace(path_, threads_); });
    return *stations_;
  }

  const std::filesystem::path& file_;
  const std::vector<Pose>& path_;
  const VehicleOptions& options_;
  int threads_;
  std::vector<Message>* warnings_;
  FollowedPath* last_;  ///< receives what is odd about the body that was placed last; may be null
  std::optional<PathStations> stations_;
};

/// The stretch that a body occupies, in metres ahead of the path's pose.
struct OccupiedLength {
  double from, to;

  double gap_to(const OccupiedLength& other) const {
    return std::max({from - other.to, other.from - to, 0.0});
  }
  void add(const OccupiedLength& other) {
    from = std::min(from, other.from);
    to = std::max(to, other.to);
  }
};

/// A body that follows the path, placed on a straight path.
struct BodyAhead {
  const BodyEntry& entry;
  OccupiedLength body, pivots;
};

/// How far the origin of each body is ahead of the path's pose on a straight path; none for bodies
/// with a trajectory of their own, and for those that they tow.
std::vector<std::optional<double>> origins_ahead(const std::vector<BodyEntry>& entries,
                                                 const Towing& towing) {
  std::vector<std::optional<double>> ahead;
  for (const BodyEntry& entry : entries) {
    const auto* station = std::get_if<BodyStation>(&entry.mount);
    ahead.push_back(station != nullptr ? station->at : 0);
    if (!entry.trajectory.empty()) ahead.back().reset();
  }
  for (const std::size_t i : towing.order) {
    const auto& tow = std::get<BodyTowed>(entries[i].mount);
    const std::optional<double> tower = towing.tower[i] ? ahead[*towing.tower[i]] : 0.0;
    if (tower) {
      ahead[i] = *tower + tow.at - tow.hitch;
    } else {
      ahead[i].reset();
    }
  }
  return ahead;
}

BodyAhead placed_ahead(const BodyEntry& entry, double at, const Box& box) {
  BodyAhead one{entry, {at + box.lo.x, at + box.hi.x}, {at, at}};
  if (const auto* pivots = std::get_if<BodyPivots>(&entry.mount)) {
    one.pivots = {std::min(pivots->front, pivots->rear), std::max(pivots->front, pivots->rear)};
  } else if (const auto* tow = std::get_if<BodyTowed>(&entry.mount)) {
    one.pivots = {at + tow->axle, at + tow->hitch};
  }
  return one;
}

double horizontal_length(const Box& box) {
  return std::max(box.hi.x - box.lo.x, box.hi.y - box.lo.y);
}

/// A body is far from the vehicle where this many times the longest body fits in between.
constexpr double kFarLengths = 3;

void warn_far(const std::filesystem::path& file, const BodyAhead& one, const std::string& what,
              double gap, double longest, std::vector<Message>& warnings) {
  warnings.push_back(warning("body-far", {{"gap", gap}, {"length", longest}},
                             "{}: {} ({}): {} {} m away, and the longest body of the vehicle has "
                             "{} m. Stations and pivots are metres ahead of the path's pose, "
                             "negative ones behind: check their sign and their unit",
                             file.string(), one.entry.at.key(), one.entry.name, what,
                             format_brief(gap), format_brief(longest)));
}

/// Warns of bodies that are far from the others, as with mistyped stations or pivots. Such a body
/// is moved along a path that it does not drive, and hardly anything near its true path is
/// searched.
void warn_of_far_bodies(const std::filesystem::path& file, const std::vector<BodyEntry>& entries,
                        const std::vector<Body>& bodies, std::vector<Message>& warnings) {
  std::vector<BodyAhead> apart;
  double longest = 0;
  const auto ahead = origins_ahead(entries, towing_of(entries));
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].model.empty() || !ahead[i]) continue;
    const Box box = box_of(bodies[i].model.vertices);
    longest = std::max(longest, horizontal_length(box));
    apart.push_back(placed_ahead(entries[i], *ahead[i], box));
  }
  const double far = kFarLengths * longest;
  if (!(far > 0)) return;
  for (const BodyAhead& one : apart) {
    if (!std::holds_alternative<BodyStation>(one.entry.mount) &&
        one.body.gap_to(one.pivots) > far) {
      warn_far(file, one, "the pivots and the model are", one.body.gap_to(one.pivots), longest,
               warnings);
    }
  }
  // The vehicle grows from the path's pose, as a train does wagon by wagon.
  OccupiedLength vehicle{0, 0};
  const auto near = [&](const BodyAhead& one) { return vehicle.gap_to(one.body) <= far; };
  for (auto next = std::ranges::find_if(apart, near); next != apart.end();
       next = std::ranges::find_if(apart, near)) {
    vehicle.add(next->body);
    std::vector<BodyAhead> rest;
    for (auto one = apart.begin(); one != apart.end(); ++one) {
      if (one != next) rest.push_back(*one);
    }
    apart.swap(rest);
  }
  for (const BodyAhead& one : apart) {
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
  for (const BodyEntry& entry : entries) {
    bodies.push_back({.name = entry.name,
                      .model = reader.read_model_of(entry),
                      .poses = {},
                      .path_pose = {},
                      .floor = entry.floor});
    if (!std::holds_alternative<BodyTowed>(entry.mount)) reader.place(entry, bodies.back());
  }
  reader.place_towed(entries, towing_of(entries), bodies);
  if (warnings != nullptr) warn_of_far_bodies(file, entries, bodies, *warnings);
  return bodies;
}

namespace {

/// The body with this name after all its towers.
std::vector<BodyEntry> with_towers(const std::vector<BodyEntry>& entries, const std::string& name,
                                   const std::filesystem::path& file) {
  auto found = std::ranges::find(entries, name, &BodyEntry::name);
  if (found == entries.end()) {
    std::string names;
    for (const BodyEntry& entry : entries) names += (names.empty() ? "" : ", ") + entry.name;
    throw UsageError(file.string() + ": no body is named \"" + name + "\"; expected one of " +
                     names);
  }
  std::vector<BodyEntry> chain;
  const std::vector<std::optional<std::size_t>> tower = towing_of(entries).tower;
  auto body = static_cast<std::size_t>(found - entries.begin());
  for (chain.push_back(entries[body]); tower[body]; body = *tower[body]) {
    chain.insert(chain.begin(), entries[*tower[body]]);
  }
  return chain;
}

}  // namespace

Body place_body(const std::filesystem::path& file, const std::string& name,
                const std::vector<Pose>& path, const VehicleOptions& options,
                std::vector<Message>* warnings, FollowedPath& followed) {
  const std::vector<BodyEntry> chain =
      with_towers(read_vehicle_file(file, options.model.environment_unit), name, file);
  VehicleReader reader(file, path, options, warnings, &followed);
  std::vector<Body> bodies;
  for (const BodyEntry& entry : chain) {
    bodies.push_back({.name = entry.name, .model = {}, .poses = {}, .path_pose = {}});
    if (!std::holds_alternative<BodyTowed>(entry.mount)) reader.place(entry, bodies.back());
  }
  reader.place_towed(chain, towing_of(chain), bodies);
  return std::move(bodies.back());
}

}  // namespace clearway
