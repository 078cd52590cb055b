#include "stream/stage_times.hpp"

#include <algorithm>

namespace clearway {
namespace {

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

double busy_seconds(const std::vector<PageTimes>& pages, Interval PageTimes::*stage) {
  std::vector<Interval> intervals;
  intervals.reserve(pages.size());
  for (const PageTimes& page : pages) intervals.push_back(page.*stage);
  return busy_seconds(std::move(intervals));
}

}  // namespace

double busy_seconds(std::vector<Interval> intervals) {
  std::sort(intervals.begin(), intervals.end(),
            [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
  Clock::duration busy{};
  Clock::time_point until = Clock::time_point::min();
  for (const Interval& interval : intervals) {
    if (interval.end <= until) continue;
    busy += std::max(interval.end - std::max(interval.begin, until), Clock::duration{});
    until = std::max(until, interval.end);
  }
  return seconds(busy);
}

StageTimes stage_times(const std::vector<PageTimes>& pages) {
  return {.read = busy_seconds(pages, &PageTimes::read),
          .upload = busy_seconds(pages, &PageTimes::upload),
          .compute = busy_seconds(pages, &PageTimes::compute),
          .collect = busy_seconds(pages, &PageTimes::collect)};
}

}  // namespace clearway
