#include <catch2/catch.hpp>

#include "stream/run_pages.hpp"

using namespace clearway;

namespace {

Interval interval(int begin_ms, int end_ms) {
  const Clock::time_point start{std::chrono::hours(5)};
  return {start + std::chrono::milliseconds(begin_ms), start + std::chrono::milliseconds(end_ms)};
}

}  // namespace

TEST_CASE("busy time is the length of the union of the intervals") {
  CHECK(busy_seconds({}) == 0);
  CHECK(busy_seconds({interval(10, 30)}) == Approx(0.020));
  CHECK(busy_seconds({interval(10, 30), interval(40, 50)}) == Approx(0.030));
  CHECK(busy_seconds({interval(40, 50), interval(10, 30), interval(20, 45)}) == Approx(0.040));
  CHECK(busy_seconds({interval(10, 100), interval(20, 30), interval(40, 50)}) == Approx(0.090));
  CHECK(busy_seconds({interval(10, 30), interval(30, 40)}) == Approx(0.030));
  CHECK(busy_seconds({interval(10, 30), interval(10, 30)}) == Approx(0.020));
}

TEST_CASE("intervals that were never set, and ends before begins, are no time") {
  CHECK(busy_seconds({Interval{}, interval(10, 20), Interval{}}) == Approx(0.010));
  CHECK(busy_seconds({interval(20, 10)}) == 0);
  CHECK(busy_seconds({interval(0, 30), interval(20, 10), interval(25, 40)}) == Approx(0.040));
}

TEST_CASE("each stage's time is its own") {
  const StageTimes times = stage_times({{interval(0, 10), interval(5, 15), {}, interval(30, 31)},
                                        {interval(5, 20), interval(40, 50), {}, interval(40, 41)}});
  CHECK(times.read == Approx(0.020));
  CHECK(times.upload == Approx(0.020));
  CHECK(times.compute == 0);
  CHECK(times.collect == Approx(0.002));
}
