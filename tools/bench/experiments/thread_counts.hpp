#pragma once

#include <set>

namespace clearway::bench {

/// Thread counts to measure: one, all cores and twice as many, and some sixteen steps between them.
inline std::set<int> thread_counts(int cores) {
  std::set<int> counts{1, cores, 2 * cores};
  const int step = cores > 8 ? cores / 8 : 1;
  for (int threads = step; threads < 2 * cores; threads += step) counts.insert(threads);
  return counts;
}

}  // namespace clearway::bench
