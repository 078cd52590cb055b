// The choice of a device among GPUs that are made up.
#include "search/devices.hpp"

#include <catch2/catch.hpp>

#include "clearway/error.hpp"

using namespace clearway;
using Catch::Contains;

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
  CHECK(one_with_room(machine.count(), machine.open(), kWanted, silent()).index == 1);
  CHECK(machine.opened == std::vector{0, 1});
}

TEST_CASE("where no GPU has all that is wanted, the one with the most is the last one opened") {
  // A twentieth of a GPU's memory is left to others.
  Machine machine{{300 * kMiB, 500 * kMiB, kWanted, 400 * kMiB}};
  const DeviceChoice choice =
      choice_of({one_with_room(machine.count(), machine.open(), kWanted, silent())}, kWanted);
  CHECK(machine.opened.back() == 2);
  CHECK(choice.gpus == std::vector{2});
  CHECK(choice.memory_bytes < kWanted);
  CHECK(choice.memory_bytes > kWanted / 10 * 9);
  CHECK_THAT(choice.short_device, Contains("GPU 2") && Contains("free"));
}

TEST_CASE("a GPU that cannot be used does not hide the others") {
  Machine machine{{kUnusable, 500 * kMiB, kUnusable}};
  CHECK(one_with_room(machine.count(), machine.open(), kWanted, silent()).index == 1);
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
  CHECK_THAT(tight.short_device, Contains("GPU 1") && Contains("200"));
}

TEST_CASE("the CPU is taken where there is no GPU, or none with room") {
  Machine none{{}}, full{{100 * kMiB, 200 * kMiB}}, room{{100 * kMiB, 300 * kMiB}};
  CHECK_FALSE(automatic_choice(none.count(), none.open(), kWanted, silent()).is_cuda());
  CHECK_FALSE(automatic_choice(full.count(), full.open(), kWanted, silent()).is_cuda());
  const DeviceChoice choice = automatic_choice(room.count(), room.open(), kWanted, silent());
  CHECK(choice.gpus == std::vector{1});
}
