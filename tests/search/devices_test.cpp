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

MessageLog silent() {
  static const MessageCallback nobody;
  static std::vector<Message> warnings;
  return {nobody, warnings};
}

CudaDevice gpu(int index, std::uint64_t free) { return {index, "Some GPU", 80 * kWanted, free}; }

/// GPUs, given by their free memory, and which of them were opened.
struct Machine {
  std::vector<std::uint64_t> free_bytes;
  std::vector<int> opened = {};

  int count() const { return static_cast<int>(free_bytes.size()); }
  OpenDevice open() {
    return [this](int index) {
      opened.push_back(index);
      const std::uint64_t free = free_bytes.at(static_cast<std::size_t>(index));
      if (free == kUnusable) throw ResourceError("no context on " + std::to_string(index));
      return gpu(index, free);
    };
  }
  CudaDevice one() { return one_with_room(count(), open(), kWanted, silent()); }
  /// The GPUs that are chosen where nobody asks for a device.
  std::vector<int> automatic() { return automatic_choice(count(), open(), kWanted, silent()).gpus; }
};

using Gpus = std::vector<int>;

}  // namespace

TEST_CASE("the first GPU with all the memory that is wanted is taken, or else the roomiest") {
  Machine machine{{100 * kMiB, 2 * kWanted, 3 * kWanted}};
  check_equal(machine.one().index, 1);
  CHECK(machine.opened == Gpus{0, 1});
  // A twentieth of a GPU's memory is left to others. The one that is taken is the last one opened.
  Machine tight{{300 * kMiB, 500 * kMiB, kWanted, 400 * kMiB}};
  const DeviceChoice choice = choice_of({tight.one()}, kWanted);
  check_equal(tight.opened.back(), 2);
  CHECK(choice.gpus == Gpus{2});
  CHECK(choice.memory_bytes < kWanted);
  CHECK(choice.memory_bytes > kWanted / 10 * 9);
  check_says(choice.short_device, "GPU 2 ... free");
}

TEST_CASE("a GPU that cannot be used, or has no room, does not hide the others") {
  Machine machine{{kUnusable, 500 * kMiB, kUnusable}}, broken{{kUnusable, kUnusable}};
  check_equal(machine.one().index, 1);
  CHECK(machine.automatic() == Gpus{1});
  check_refused([&] { broken.one(); }, "no context on 1");
  // The CPU is taken where no GPU has room.
  CHECK(broken.automatic() == Gpus{});
  CHECK(Machine{{}}.automatic() == Gpus{});
  CHECK(Machine{{100 * kMiB, 200 * kMiB}}.automatic() == Gpus{});
  CHECK(Machine{{100 * kMiB, 300 * kMiB}}.automatic() == Gpus{1});
}

TEST_CASE("of several GPUs the one with the least free bounds what is taken of each") {
  const DeviceChoice roomy = choice_of({gpu(0, 4 * kWanted), gpu(3, 2 * kWanted)}, kWanted);
  CHECK(roomy.gpus == Gpus{0, 3});
  CHECK(roomy.memory_bytes == kWanted);
  CHECK(roomy.short_device.empty());
  const DeviceChoice tight =
      choice_of({gpu(0, 600 * kMiB), gpu(1, 200 * kMiB), gpu(2, 4 * kWanted)}, kWanted);
  CHECK(tight.memory_bytes == 190 * kMiB);
  check_says(tight.short_device, "GPU 1 ... 200");
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

TEST_CASE("a GPU pays for many points, for fewer with fewer threads and with clearances") {
  QueryParameters query{.radius = 0.1};
  CHECK_FALSE(pays(work_of(1000), query, 16));
  CHECK(pays(work_of(1e9), query, 16));
  Workload work = work_of(1000);
  while (!pays(work, query, 2)) work.reached_points *= 1.1;
  CHECK_FALSE(pays(work, query, 64));
  work.reached_points /= 1.2;
  CHECK_FALSE(pays(work, query, 2));
  query.clearance = 0.1;
  CHECK(pays(work, query, 2));
  CHECK(surely_many_points(16) > surely_many_points(2));
  CHECK(surely_many_points(0) > 0);
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
