// The choice of a device among GPUs that are made up.
#include "search/devices.hpp"

#include <vector>

#include "clearway/error.hpp"
#include "search/device_estimate.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
constexpr std::uint64_t kWanted = 1024 * kMiB;
constexpr std::uint64_t kUnusable = 0;

/// GPUs, given by their free memory, and which of them were opened.
struct Machine {
  std::vector<std::uint64_t> free_bytes;
  std::vector<int> opened = {};

  int count() const { return static_cast<int>(free_bytes.size()); }
  OpenDevice open() {
    return [this](int gpu) {
      opened.push_back(gpu);
      const std::uint64_t free = free_bytes.at(static_cast<std::size_t>(gpu));
      if (free == kUnusable) throw ResourceError("no context on " + std::to_string(gpu));
      return CudaDevice{gpu, "Some GPU", 80 * kWanted, free};
    };
  }
};

MessageLog silent() {
  static const MessageCallback nobody;
  static std::vector<Message> warnings;
  return {nobody, warnings};
}

}  // namespace

TEST_CASE("the first GPU with all the memory that is wanted is taken, and no further one opened") {
  Machine machine{{100 * kMiB, 2 * kWanted, 3 * kWanted}};
  check_equal(one_with_room(machine.count(), machine.open(), kWanted, silent()).index, 1);
  CHECK(machine.opened == std::vector{0, 1});
}

TEST_CASE("where no GPU has all that is wanted, the one with the most is the last one opened") {
  // A twentieth of a GPU's memory is left to others.
  Machine machine{{300 * kMiB, 500 * kMiB, kWanted, 400 * kMiB}};
  const DeviceChoice choice =
      choice_of({one_with_room(machine.count(), machine.open(), kWanted, silent())}, kWanted);
  check_equal(machine.opened.back(), 2);
  CHECK(choice.gpus == std::vector{2});
  CHECK(choice.memory_bytes < kWanted);
  CHECK(choice.memory_bytes > kWanted / 10 * 9);
  check_says(choice.short_device, "GPU 2 ... free");
}

TEST_CASE("a GPU that cannot be used does not hide the others") {
  Machine machine{{kUnusable, 500 * kMiB, kUnusable}};
  check_equal(one_with_room(machine.count(), machine.open(), kWanted, silent()).index, 1);
  CHECK(automatic_choice(machine.count(), machine.open(), kWanted, silent()).gpus ==
        std::vector{1});

  Machine broken{{kUnusable, kUnusable}};
  CHECK_THROWS_WITH(one_with_room(broken.count(), broken.open(), kWanted, silent()),
                    "no context on 1");
  CHECK_FALSE(automatic_choice(broken.count(), broken.open(), kWanted, silent()).is_cuda());
}

TEST_CASE("of several GPUs the one with the least free bounds what is taken of each") {
  const auto gpu = [](int index, std::uint64_t free) {
    return CudaDevice{index, "Some GPU", 80 * kWanted, free};
  };
  const DeviceChoice roomy = choice_of({gpu(0, 4 * kWanted), gpu(3, 2 * kWanted)}, kWanted);
  CHECK(roomy.gpus == std::vector{0, 3});
  CHECK(roomy.memory_bytes == kWanted);
  CHECK(roomy.short_device.empty());
  const DeviceChoice tight =
      choice_of({gpu(0, 600 * kMiB), gpu(1, 200 * kMiB), gpu(2, 4 * kWanted)}, kWanted);
  CHECK(tight.memory_bytes == 190 * kMiB);
  check_says(tight.short_device, "GPU 1 ... 200");
}

TEST_CASE("the CPU is taken where there is no GPU, or none with room") {
  Machine none{{}}, full{{100 * kMiB, 200 * kMiB}}, room{{100 * kMiB, 300 * kMiB}};
  CHECK_FALSE(automatic_choice(none.count(), none.open(), kWanted, silent()).is_cuda());
  CHECK_FALSE(automatic_choice(full.count(), full.open(), kWanted, silent()).is_cuda());
  const DeviceChoice choice = automatic_choice(room.count(), room.open(), kWanted, silent());
  CHECK(choice.gpus == std::vector{1});
}

// The choice between CPU and GPU by estimate.
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
