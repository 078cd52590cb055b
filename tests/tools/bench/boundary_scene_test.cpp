#include "bench/variants/boundary_scene.hpp"

#include <cmath>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "core/geometry/predicate.hpp"
#include "io/scans/las/las_reader.hpp"
#include "support/catch.hpp"
#include "support/compare_json.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using namespace clearway::bench;

namespace {

constexpr double kRadius = 0.1;

Json decided(const ScratchFolder& folder, const std::vector<std::uint64_t>& hits) {
  ResultHeader header = sample_header(false);
  header.environment_points = steps_beside_boundary().size();
  write_result(folder / "r.h5", header,
               {.source = hits, .xyz = std::vector<Vec3>(hits.size()), .first_pose = {}});
  return decided_at_boundary(folder / "r.h5");
}

}  // namespace

TEST_CASE("the points lie as many ulps beside the radius as said, and collide within it") {
  const ScratchFolder folder;
  const auto las = folder / "e.las";
  write_boundary_scene(las, folder / "m.ply", folder / "t.txt", kRadius);
  const auto reader = read_las({File::open_for_reading(las), InputBuffer::Access::kSeek});
  const Quantisation quantisation = *reader->info().quantisation;
  const std::vector<std::int32_t> steps = steps_beside_boundary();
  std::size_t read = 0;
  bool exact = true, as_said = true;
  for (PointBatch batch; reader->read(batch);) {
    for (const auto& q : batch.quanta) {
      const double x = q[0] * quantisation.scale[0] + quantisation.offset[0];
      exact &= x - kRadius == steps.at(read) * (std::nextafter(kRadius, 1) - kRadius);
      as_said &= (squared_distance({x, 0, 0}, {}) < kRadius * kRadius) == (steps.at(read) < 0);
      ++read;
    }
  }
  CHECK(read == steps.size());
  CHECK(exact);
  CHECK(as_said);
  CHECK(read_model_points(folder / "m.ply") == std::vector<Vec3>{{0, 0, 0}});
  CHECK(read_trajectory(folder / "t.txt", {}).size() == 1);
}

TEST_CASE("wrong points are counted by the octave of their steps") {
  const ScratchFolder folder;
  const std::vector<std::int32_t> steps = steps_beside_boundary();
  std::vector<std::uint64_t> hits;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] < 0) hits.push_back(i);
  }
  const Json right = decided(folder, hits);
  check_json(right, R"({"false_hits": 0, "misses": 0, "points": {"0": 129, "30": 128}})");
  hits.pop_back();                    // a hit of the last octave
  hits.insert(hits.begin(), {0, 1});  // 0 and 1 ulps
  const Json wrong = decided(folder, hits);
  check_json(wrong, R"({"false_hits": 2, "misses": 1})");
  for (int i = 0; i < 31; ++i) CHECK(wrong["wrong"][i] == (i == 0 ? 2 : i == 30 ? 1 : 0));
}
