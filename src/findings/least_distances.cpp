#include "findings/least_distances.hpp"

#include "io/result/result_rows.hpp"

namespace clearway {

std::vector<ConflictDistance> least_distances(const ResultReader& result,
                                              std::span<const std::uint64_t> source,
                                              std::span<const std::uint32_t> conflict_of,
                                              std::size_t conflicts, Progress& progress) {
  std::vector<ConflictDistance> out(conflicts + 1);
  progress.begin("distances", result.clearances(), "points");
  ClearanceRowStream stream(result);
  std::size_t row = 0;
  for (ClearanceRows rows; stream.read(rows);) {
    throw_if_stopped(progress);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      while (row < source.size() && source[row] < rows.source[i]) ++row;
      if (row == source.size() || source[row] != rows.source[i]) continue;
      if (conflict_of[row] == 0) continue;
      ConflictDistance& least = out[conflict_of[row]];
      if (rows.distance[i] < 0) ++least.inside;
      if (least.source == ConflictDistance::kNone || rows.distance[i] < least.distance) {
        least = {rows.distance[i],
                 rows.source[i],
                 rows.pose[i],
                 rows.xyz.empty() ? std::nullopt : std::optional(rows.xyz[i]),
                 rows.body.empty() ? std::nullopt : std::optional(rows.body[i]),
                 least.inside};
      }
    }
    progress.advance(rows.size());
  }
  progress.end();
  return out;
}

}  // namespace clearway
