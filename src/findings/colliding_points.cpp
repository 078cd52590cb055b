#include "findings/colliding_points.hpp"

#include <algorithm>
#include <atomic>
#include <string>

#include "io/files/input_error.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/result/result.hpp"
#include "io/scans/requantize.hpp"

namespace clearway {
namespace {

constexpr std::size_t kAll = ~std::size_t{0};

/// Computes the stored integers of all rows. Returns the first row whose coordinates are not those
/// of stored integers, or kAll.
std::size_t requantize_rows(const Quantisation& quantisation, const std::vector<Vec3>& xyz,
                            QuantumPoint* out) {
  std::atomic<std::size_t> bad{kAll};
  using Range = tbb::blocked_range<std::size_t>;
  for_each_parallel(Range(0, xyz.size(), 4096), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const auto q = quantum_at(quantisation, k, xyz[i][k]);
        out[i].q[k] = q.value_or(0);
        if (q) continue;
        std::size_t first = bad.load();
        while (i < first && !bad.compare_exchange_weak(first, i)) continue;
      }
    }
  });
  return bad.load();
}

/// Reads the near points, whose last pose is taken for their first one, because no search looks for
/// it.
CollidingPoints read_near_points(const ResultReader& result, Progress& progress) {
  CollidingPoints out;
  RowStream<Nearby> stream(result);
  for (Nearby rows; stream.read(rows);) {
    throw_if_stopped(progress);
    std::vector<QuantumPoint> quanta(rows.size());
    const std::size_t bad = requantize_rows(result.header().quantisation, rows.xyz, quanta.data());
    if (bad != kAll) {
      refuse(result.name(), "/near/xyz, source " + std::to_string(rows.source[bad]) +
                                ": expected a whole multiple of the scale above the offset");
    }
    out.quanta.insert(out.quanta.end(), quanta.begin(), quanta.end());
    out.source.insert(out.source.end(), rows.source.begin(), rows.source.end());
    out.first_pose.insert(out.first_pose.end(), rows.first_pose.begin(), rows.first_pose.end());
    for (const std::uint32_t body : rows.body) out.body.push_back(static_cast<std::uint8_t>(body));
    out.point_class.insert(out.point_class.end(), rows.point_class.begin(), rows.point_class.end());
    progress.advance(rows.size());
  }
  out.last_pose = out.first_pose;
  out.kind.resize(out.source.size(), CollidingPoints::kNear);
  return out;
}

/// All points of both, ascending by source.
CollidingPoints merged(const CollidingPoints& a, const CollidingPoints& b) {
  CollidingPoints out;
  const auto take = [&out](const CollidingPoints& from, std::size_t i) {
    out.quanta.push_back(from.quanta[i]);
    out.source.push_back(from.source[i]);
    out.first_pose.push_back(from.first_pose[i]);
    out.last_pose.push_back(from.last_pose[i]);
    if (!from.body.empty()) out.body.push_back(from.body[i]);
    out.kind.push_back(from.kind[i]);
    if (!from.point_class.empty()) out.point_class.push_back(from.point_class[i]);
  };
  std::size_t i = 0, k = 0;
  while (i < a.source.size() || k < b.source.size()) {
    const bool first = k == b.source.size() || (i < a.source.size() && a.source[i] < b.source[k]);
    if (first) take(a, i++);
    if (!first) take(b, k++);
  }
  return out;
}

}  // namespace

CollidingPoints read_colliding_points(const ResultReader& result, Progress& progress) {
  CollidingPoints out;
  out.quanta.resize(result.collisions());
  out.source.reserve(result.collisions());
  out.first_pose.reserve(result.collisions());
  out.last_pose.reserve(result.collisions());
  if (result.header().has_first_bodies()) out.body.reserve(result.collisions());
  if (result.header().has_classes()) out.point_class.reserve(result.collisions());
  progress.begin("read", result.collisions() + result.near(), "points");
  RowStream<Collisions> stream(result);
  for (Collisions rows; stream.read(rows);) {
    throw_if_stopped(progress);
    const std::size_t bad = requantize_rows(result.header().quantisation, rows.xyz,
                                            out.quanta.data() + out.source.size());
    if (bad != kAll) {
      refuse(result.name(), "/collisions/xyz, source " + std::to_string(rows.source[bad]) +
                                ": expected a whole multiple of the scale above the offset");
    }
    out.source.insert(out.source.end(), rows.source.begin(), rows.source.end());
    out.first_pose.insert(out.first_pose.end(), rows.first_pose.begin(), rows.first_pose.end());
    out.last_pose.insert(out.last_pose.end(), rows.last_pose.begin(), rows.last_pose.end());
    for (const std::uint32_t body : rows.body) out.body.push_back(static_cast<std::uint8_t>(body));
    out.point_class.insert(out.point_class.end(), rows.point_class.begin(), rows.point_class.end());
    for (const std::uint8_t certain : rows.certain) {
      out.kind.push_back(certain != 0 ? CollidingPoints::kCertain : CollidingPoints::kColliding);
    }
    progress.advance(rows.size());
  }
  if (result.near() > 0) out = merged(out, read_near_points(result, progress));
  progress.end();
  return out;
}

}  // namespace clearway
