#pragma once

#include <vector>

#include "core/page/page_engine.hpp"

namespace clearway {

/// The times at which the stages of one page ran.
struct PageTimes {
  Interval read{}, upload{}, compute{}, collect{};
};

/// Wall-clock seconds in which at least one worker of a stage was busy.
struct StageTimes {
  double read = 0;  ///< including staging and checking
  double upload = 0;
  double compute = 0;
  double collect = 0;
  double total = 0;  ///< seconds from the first page to the last one
};

/// Length of the union of the intervals, seconds. An interval that does not end after it begins has
/// no length.
double busy_seconds(std::vector<Interval> intervals);

StageTimes stage_times(const std::vector<PageTimes>& pages);

}  // namespace clearway
