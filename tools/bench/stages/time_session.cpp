#include "bench/stages/time_session.hpp"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <future>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "clearway/model.hpp"
#include "clearway/session.hpp"
#include "clearway/trajectory.hpp"
#include "core/util/stopwatch.hpp"
#ifdef CLEARWAY_NANOFLANN
#include "bench/peers/nanoflann_search.hpp"
#include "io/store/store_reader.hpp"
#endif

namespace clearway::bench {
namespace {

using nlohmann::ordered_json;

/// A prime, so that its multiples modulo the number of poses are spread over the path.
constexpr std::uint64_t kStride = 7919;

Device device_named(const std::string& name) {
  return name == "cpu" ? Device::kCpu : name == "cuda" ? Device::kCuda : Device::kAuto;
}

/// Bytes of the process that are in memory.
std::uint64_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  statm >> all >> resident;
  return resident * 4096;
}

/// Adds the parts of one question. Those of the search overlap where it has several threads.
void add_parts(const SearchSeconds& seconds, std::map<std::string, double>& parts) {
  parts["check"] += seconds.check;
  parts["field"] += seconds.field;
  parts["plan"] += seconds.plan;
  parts["engine"] += seconds.engine;
  parts["search"] += seconds.search;
  parts["read"] += seconds.read;
  parts["compute"] += seconds.compute;
  parts["tables"] += seconds.write;
  parts["total"] += seconds.total;
}

struct Asking {
  std::vector<double> seconds;
  std::map<std::string, double> parts;
  std::set<std::uint64_t> points;  ///< the colliding points of all answers
  double wall = 0;
};

/// Asks `count` questions, with so many threads.
Asking ask(const Session& session, const SessionTimes& options, const Model& model,
           const std::vector<Pose>& poses, std::uint64_t count, bool in_order) {
  Asking all;
  std::mutex mutex;
  std::atomic<std::uint64_t> next = 0;
  const auto work = [&] {
    Query query(model, {Pose{}}, {.radius = options.radius, .profile = options.distance});
    Asking own;
    for (std::uint64_t i = next++; i < count; i = next++) {
      query.poses[0] = poses[in_order ? i : i * kStride % poses.size()];
      const Stopwatch clock;
      const SessionAnswer answer = session.search(query);
      own.seconds.push_back(clock.seconds());
      add_parts(answer.seconds, own.parts);
      if (in_order) {
        own.points.insert(answer.collisions().source.begin(), answer.collisions().source.end());
      }
    }
    const std::lock_guard lock(mutex);
    all.seconds.insert(all.seconds.end(), own.seconds.begin(), own.seconds.end());
    for (const auto& [name, seconds] : own.parts) all.parts[name] += seconds;
    all.points.merge(own.points);
  };
  const Stopwatch clock;
  std::vector<std::future<void>> askers;
  for (int i = 0; i < options.askers; ++i) askers.push_back(std::async(std::launch::async, work));
  for (std::future<void>& asker : askers) asker.get();
  all.wall = clock.seconds();
  std::ranges::sort(all.seconds);
  return all;
}

ordered_json json_of(const Asking& asking) {
  const std::size_t count = asking.seconds.size();
  ordered_json out = {{"questions", count},
                      {"median_ms", 1e3 * asking.seconds[count / 2]},
                      {"p99_ms", 1e3 * asking.seconds[count * 99 / 100]},
                      {"per_second", static_cast<double>(count) / asking.wall}};
  for (const auto& [name, seconds] : asking.parts) {
    out["mean_ms"][name] = 1e3 * seconds / static_cast<double>(count);
  }
  return out;
}

/// The whole trajectory in one question against its poses one by one.
ordered_json compare_with_one_run(const Session& session, const SessionTimes& options,
                                  const Model& model, const std::vector<Pose>& poses) {
  const Asking one_by_one = ask(session, options, model, poses, poses.size(), true);
  const Stopwatch clock;
  const SessionAnswer answer =
      session.search({model, poses, {.radius = options.radius, .profile = options.distance}});
  const double seconds = clock.seconds();
  return {{"poses", poses.size()},
          {"one_by_one_seconds", one_by_one.wall},
          {"one_question_seconds", seconds},
          {"same_points", std::ranges::equal(one_by_one.points, answer.collisions().source)}};
}

#ifdef CLEARWAY_NANOFLANN
/// The positions of a cloud's points.
std::vector<Vec3> positions_of(const PackedCloud& cloud) {
  std::vector<Vec3> points;
  points.reserve(cloud.point_count());
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) {
    const auto chunks = cloud.coordinates(cell);
    for (std::uint32_t i = 0; i < cloud.cells()[cell].count; ++i) {
      points.push_back(position(cloud.quantisation(), chunks[0][i], chunks[1][i], chunks[2][i]));
    }
  }
  return points;
}

/// One pose at a time with nanoflann: a radius search and a nearest neighbour for each model point.
ordered_json time_peer(const SessionTimes& options, const Model& model,
                       const std::vector<Pose>& poses) {
  constexpr std::uint64_t kQuestions = 50;
  const StoreReader store(options.environment);
  const std::vector<Vec3> points = positions_of(store);
  const Stopwatch building;
  const NanoflannSearch search(points);
  const double built = building.seconds();
  std::vector<double> set, distance;
  for (std::uint64_t i = 0; i < kQuestions; ++i) {
    const Query query(model, {poses[i * kStride % poses.size()]}, {.radius = options.radius});
    const Stopwatch of_set;
    search.set(query);
    set.push_back(of_set.seconds());
    const Stopwatch of_distance;
    search.least_distance(query);
    distance.push_back(of_distance.seconds());
  }
  std::ranges::sort(set);
  std::ranges::sort(distance);
  return {{"build_seconds", built},
          {"median_set_ms", 1e3 * set[kQuestions / 2]},
          {"median_least_distance_ms", 1e3 * distance[kQuestions / 2]}};
}
#endif

}  // namespace

ordered_json time_session(const SessionTimes& options) {
  const Stopwatch opening;
  const Session session(options.environment, {.device = device_named(options.device),
                                              .threads = options.threads,
                                              .device_memory_bytes = options.device_memory_bytes});
  ordered_json out = {{"points", session.store().point_count()},
                      {"opened_seconds", opening.seconds()},
                      {"threads", options.threads},
                      {"askers", options.askers},
                      {"device", options.device},
                      {"distance", options.distance}};
  const Model model = read_model(options.model);
  const std::vector<Pose> poses = read_trajectory(options.trajectory, {});
  out["model_elements"] = model.element_count();
  const Stopwatch first;
  SessionTimes alone = options;
  alone.askers = 1;
  ask(session, alone, model, poses, 1, false);
  out["first_question_seconds"] = first.seconds();
  ask(session, options, model, poses, options.questions, false);  // the field's bricks are made
  out["asked"] = json_of(ask(session, options, model, poses, options.questions, false));
  out["kept_bytes"] = session.kept_bytes();
  out["resident_bytes"] = resident_bytes();
  if (options.one_run) out["one_run"] = compare_with_one_run(session, options, model, poses);
  if (options.repeat_memory > 0) {
    out["resident_before_bytes"] = resident_bytes();
    ask(session, options, model, poses, options.repeat_memory, false);
    out["resident_after_bytes"] = resident_bytes();
    out["further_questions"] = options.repeat_memory;
  }
#ifdef CLEARWAY_NANOFLANN
  if (options.peer) out["nanoflann"] = time_peer(options, model, poses);
#endif
  return out;
}

}  // namespace clearway::bench
