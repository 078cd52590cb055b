#pragma once

#include <vector>

#include "core/page/page_engine.hpp"

namespace clearway {

/// When the stages of one page ran.
struct PageTimes {
  Interval read{}, upload{}, compute{}, collect{};
};

/// Wall clock in which at least one worker of a stage was busy, seconds.
struct StageTimes {
  double read = 0;  ///< staging and checking included
  double upload = 0;
  double compute = 0;
  double collect = 0;
  double total = 0;  ///< from the first page to the last
};

/// Length of the union of the intervals, seconds. One that does not end after it begins has none.
double busy_seconds(std::vector<Interval> intervals);

StageTimes stage_times(const std::vector<PageTimes>& pages);

}  // namespace clearway
