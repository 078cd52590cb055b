#include "bench/peers/compare_engines.hpp"

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "bench/peers/nanoflann_search.hpp"
#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "cpu/kdtree_engine.hpp"
#include "io/store/store_reader.hpp"

namespace clearway::bench {
namespace {

template <typename Run>
double seconds_of(Run run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

nlohmann::json timing(const std::vector<double>& seconds, std::uint64_t searches) {
  return {{"seconds", seconds},
          {"median_seconds", median(seconds)},
          {"searches_per_second", static_cast<double>(searches) / median(seconds)}};
}

/// Calls visit(slot, index) for the used slots in order; index counts them from 0.
template <typename Visit>
void for_each_point(const PackedCloud& cloud, Visit visit) {
  std::uint64_t index = 0;
  for (std::size_t cell = 0; cell < cloud.cells().size(); ++cell) {
    for (std::uint32_t i = 0; i < cloud.cells()[cell].count; ++i) {
      visit(cell * cloud.cell_entries() + i, index++);
    }
  }
}

std::uint64_t differing_points(const PackedCloud& cloud, const HitSet& hits,
                               const NanoflannSearch::SearchResult& answer) {
  std::uint64_t differing = 0;
  for_each_point(cloud, [&](std::uint64_t slot, std::uint64_t index) {
    const bool peer = (answer.words[index / 64] >> (index % 64) & 1) != 0;
    differing += hits.contains(slot) != peer;
  });
  return differing;
}

}  // namespace

std::vector<Vec3> positions_by_slot(const PackedCloud& cloud) {
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

namespace {

nlohmann::json compare(const PackedCloud& cloud, const Query& query,
                       const CompareOptions& options) {
  const int threads = options.threads > 0 ? options.threads : omp_get_max_threads();
  NoProgress progress;
  KdTreeStatistics statistics;
  HitSet hits(0, false);
  std::vector<double> ours;
  ours.reserve(static_cast<std::size_t>(options.repetitions));
  for (int i = 0; i < options.repetitions; ++i) {
    ours.push_back(
        seconds_of([&] { hits = run_kdtree(cloud, query, {threads}, progress, &statistics); }));
  }
  nlohmann::json out = {{"environment_points", cloud.point_count()},
                        {"model_points", query.model.vertices.size()},
                        {"poses", query.poses.size()},
                        {"radius", query.radius},
                        {"threads", threads},
                        {"searches", statistics.searches},
                        {"colliding_points", hits.count()}};
  out["kdtree"] = timing(ours, statistics.searches);
  out["kdtree"]["tested_searches"] = statistics.tested_searches;
  out["kdtree"]["cache_bytes"] = statistics.cache_bytes;
  out["kdtree"]["bytes_per_point"] =
      static_cast<double>(statistics.allocated_bytes) / static_cast<double>(cloud.point_count());
  if (!options.peer) return out;

  const std::vector<Vec3> points = positions_by_slot(cloud);
  std::unique_ptr<NanoflannSearch> peer;
  const double build = seconds_of([&] { peer = std::make_unique<NanoflannSearch>(points); });
  NanoflannSearch::SearchResult answer;
  std::vector<double> theirs;
  theirs.reserve(static_cast<std::size_t>(options.repetitions));
  for (int i = 0; i < options.repetitions; ++i) {
    theirs.push_back(seconds_of([&] { answer = peer->run(query, threads); }));
  }
  out["nanoflann"] = timing(theirs, statistics.searches);
  out["nanoflann"]["build_seconds"] = build;
  out["nanoflann"]["empty_searches"] = answer.empty_searches;
  out["ratio"] = median(theirs) / median(ours);
  out["differing_points"] = differing_points(cloud, hits, answer);
  return out;
}

}  // namespace

nlohmann::json compare_engines(const CompareOptions& options) {
  const StoreReader store(options.environment);
  const std::vector<Vec3> model =
      read_model_points(options.model, {.spacing = options.radius / 4});  // as in clearway run
  const std::vector<Pose> all = read_trajectory(options.trajectory, {});
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < all.size(); i += options.every_pose) poses.push_back(all[i]);
  return compare(store, {model, poses, {options.radius, options.first_pose}}, options);
}

}  // namespace clearway::bench
