#include "predicate_check.hpp"

#include <iostream>

#include "clearway/error.hpp"
#include "gpu/devices.hpp"
#include "support/predicate_cases.hpp"

using namespace clearway;

TEST_CASE("the predicate on the device is the host's bit for bit") {
  const auto cases = test::cases_at_the_radius(1'000'000);
  if (cuda_device_count() == 0) {
    std::cout << "no CUDA device here: the device's refusal is tested instead\n";
    CHECK_THROWS_AS(decide_on_device(cases), ResourceError);
    return;
  }
  test::check_decided(cases, decide_on_device(cases));
}
