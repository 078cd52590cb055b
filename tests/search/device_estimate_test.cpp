// The choice between CPU and GPU by estimate.
#include <catch2/catch.hpp>
#include <vector>

#include "search/choose_engine.hpp"

using namespace clearway;

namespace {

Workload work_of(double reached_points) {
  Workload work;
  work.reached_points = reached_points;
  work.model_points = 50'000;
  work.poses = 10'000;
  return work;
}

bool pays(const Workload& work, const QueryParameters& query, int threads) {
  const DeviceEstimate estimate = estimate_devices({&work, 1}, query, threads);
  return estimate.cuda < estimate.cpu;
}

}  // namespace

TEST_CASE("a GPU pays for many points and not for few") {
  const QueryParameters set{.radius = 0.1};
  CHECK_FALSE(pays(work_of(1000), set, 16));
  CHECK(pays(work_of(1e9), set, 16));
}

TEST_CASE("a GPU pays earlier with fewer threads and with clearances") {
  QueryParameters query{.radius = 0.1};
  Workload work = work_of(1000);
  while (!pays(work, query, 2)) work.reached_points *= 1.1;
  CHECK_FALSE(pays(work, query, 64));
  work.reached_points /= 1.2;
  CHECK_FALSE(pays(work, query, 2));
  query.clearance = 0.1;
  CHECK(pays(work, query, 2));
}

TEST_CASE("bodies take as long as one after the other, and the GPU starts once") {
  const std::vector<Workload> bodies(3, work_of(1e7));
  const QueryParameters query{.radius = 0.1, .clearance = 0.5};
  const DeviceEstimate one = estimate_devices({bodies.data(), 1}, query, 4);
  const DeviceEstimate all = estimate_devices(bodies, query, 4);
  CHECK(all.cpu == Approx(3 * one.cpu));
  CHECK(all.cuda > one.cuda);
  CHECK(all.cuda < 3 * one.cuda);
}

TEST_CASE("a GPU pays for few points with many beams, which are followed once for all bodies") {
  const QueryParameters query{.radius = 0.1, .seen = true};
  std::vector<Workload> bodies(3, work_of(1000));
  CHECK_FALSE(pays(bodies[0], query, 16));
  for (Workload& work : bodies) work.beams = 1e9;
  CHECK(pays(bodies[0], query, 16));
  const double one = estimate_devices({bodies.data(), 1}, query, 16).cpu;
  CHECK(estimate_devices(bodies, query, 16).cpu < 1.1 * one);
}

TEST_CASE("more threads need more points before a GPU is started ahead") {
  CHECK(surely_many_points(16) > surely_many_points(2));
  CHECK(surely_many_points(0) > 0);
}
