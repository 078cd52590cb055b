// The main program of all peers: reads a store, a model and a trajectory as `clearway run` does,
// lets the peer search, and compares its points with the exact ones.

#include <omp.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>

#include "bench/peers/programs/peer.hpp"
#include "clearway/model.hpp"
#include "clearway/session.hpp"
#include "clearway/trajectory.hpp"
#include "core/geometry/box.hpp"
#include "io/store/store_reader.hpp"

namespace clearway::bench {
namespace {

struct Arguments {
  std::filesystem::path model, trajectory;
  PeerOptions options;
  double limit = 60;
  int repetitions = 3;
};

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The most memory that the process has had so far.
double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// The memory that the process has now.
double resident_bytes() {
  std::uint64_t total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

std::vector<Pose> every_nth(std::span<const Pose> poses, std::size_t n) {
  std::vector<Pose> out;
  for (std::size_t i = 0; i < poses.size(); i += n) out.push_back(poses[i]);
  return out;
}

double seconds_of_search(Peer& peer, std::span<const Pose> poses, std::span<const Vec3> model,
                         Marks& marks) {
  const auto start = Clock::now();
  peer.search(poses, model, marks);
  return seconds_since(start);
}

/// The least n for which every n-th pose takes less than the limit, by the time of a few poses all
/// along the way.
std::size_t poses_within(double limit, Peer& peer, std::span<const Pose> poses,
                         std::span<const Vec3> model, std::size_t points, int threads) {
  Marks unused(points);
  for (std::size_t few = static_cast<std::size_t>(threads);; few *= 4) {
    const std::size_t n = std::max<std::size_t>(1, poses.size() / few);
    if (n == 1) return 1;
    const std::vector<Pose> some = every_nth(poses, n);
    const double seconds = seconds_of_search(peer, some, model, unused);
    const double all =
        seconds * static_cast<double>(poses.size()) / static_cast<double>(some.size());
    // A measurement of a tenth of the limit is long enough to be trusted.
    if (seconds > limit / 10 || all < limit) {
      return std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(all / limit)));
    }
  }
}

struct Points {
  std::vector<Vec3> positions;
  std::vector<std::uint64_t> sources;  ///< their source indices
};

Points points_of(const StoreReader& store) {
  Points out;
  const std::uint64_t count = store.point_count();
  out.positions.reserve(count);
  out.sources.reserve(count);
  for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
    const auto chunks = store.coordinates(cell);
    const auto sources = store.sources(cell);
    for (std::uint32_t i = 0; i < store.cells()[cell].count; ++i) {
      out.positions.push_back(
          position(store.quantisation(), chunks[0][i], chunks[1][i], chunks[2][i]));
      out.sources.push_back(sources[i]);
    }
  }
  return out;
}

/// Compares what the peer marked with the points that collide. exact: their source indices in
/// ascending order.
nlohmann::json compare(const Marks& marks, const Points& points,
                       std::span<const std::uint64_t> exact) {
  std::uint64_t colliding = 0, false_hits = 0, misses = 0, found = 0;
  for (std::size_t i = 0; i < points.sources.size(); ++i) {
    const bool is = std::ranges::binary_search(exact, points.sources[i]), said = marks.contains(i);
    colliding += is;
    found += said;
    false_hits += said && !is;
    misses += is && !said;
  }
  return {{"colliding_points", colliding},
          {"found_points", found},
          {"false_hits", false_hits},
          {"misses", misses}};
}

nlohmann::json run(const Arguments& arguments) {
  const StoreReader store(arguments.options.environment);
  const Points points = points_of(store);
  const std::vector<Vec3> model = read_model_points(
      arguments.model, {.spacing = arguments.options.radius / 4});  // as in clearway run
  const std::vector<Pose> all = read_trajectory(arguments.trajectory, {});

  const double before = resident_bytes();
  const auto start = Clock::now();
  const std::unique_ptr<Peer> peer = make_peer(points.positions, arguments.options);
  const double prepare = seconds_since(start);
  const int threads = arguments.options.threads;
  const std::size_t every =
      poses_within(arguments.limit, *peer, all, model, points.positions.size(), threads);
  const std::vector<Pose> poses = every_nth(all, every);
  std::vector<double> seconds;
  Marks marks(points.positions.size());
  for (int i = 0; i < arguments.repetitions; ++i) {
    seconds.push_back(seconds_of_search(*peer, poses, model, marks));
    if (seconds.back() > arguments.limit / 2) break;
  }
  const double peak = peak_bytes();

  Session session(arguments.options.environment, {.device = Device::kCpu, .threads = threads});
  const SessionAnswer exact =
      session.search({{model}, poses, {.radius = arguments.options.radius}});
  nlohmann::json out = compare(marks, points, exact.collisions().source);
  out.update({{"peer", peer->about()},
              {"environment_points", points.positions.size()},
              {"model_points", model.size()},
              {"poses", all.size()},
              {"radius", arguments.options.radius},
              {"threads", threads},
              {"every_pose", every},
              {"searched_poses", poses.size()},
              {"prepare_seconds", prepare},
              {"search_seconds", seconds},
              {"peak_bytes_of_peer", std::max(0.0, peak - before)}});
  std::ranges::sort(seconds);
  out["all_poses_seconds"] = seconds[seconds.size() / 2] * static_cast<double>(all.size()) /
                             static_cast<double>(poses.size());
  return out;
}

int run_program(int argc, char** argv) {
  Arguments arguments;
  arguments.options.threads = omp_get_max_threads();
  CLI::App app(
      "Finds the environment points near a moved model with another library, and compares "
      "them with the exact ones; prints JSON");
  app.add_option("--env", arguments.options.environment, "Store of the environment")->required();
  app.add_option("--model", arguments.model, "Model")->required();
  app.add_option("--trajectory", arguments.trajectory, "Trajectory")->required();
  app.add_option("--radius", arguments.options.radius, "Metres")->capture_default_str();
  app.add_option("--threads", arguments.options.threads, "Threads (default: all cores)");
  app.add_option("--cell", arguments.options.cell, "Edge of a voxel in metres, for octomap")
      ->capture_default_str();
  app.add_option("--method", arguments.options.method, "One of several, for inverse");
  app.add_option("--limit", arguments.limit,
                 "Seconds of a search; where all poses take longer, every n-th is searched")
      ->capture_default_str();
  app.add_option("--repetitions", arguments.repetitions, "Searches; the median counts")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::printf("%s\n", run(arguments).dump(2).c_str());
  return 0;
}

}  // namespace

Vec3 middle_of(std::span<const Vec3> points) {
  Box box{points[0], points[0]};
  for (const Vec3& p : points) box = box.united(Box{p, p});
  Vec3 middle;
  for (int k = 0; k < 3; ++k) middle[k] = (box.lo[k] + box.hi[k]) / 2;
  return middle;
}

}  // namespace clearway::bench

int main(int argc, char** argv) {
  try {
    return clearway::bench::run_program(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
