#include "stream/journalled_work.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace clearway {

JournalledWork journalled_work(const JournalReader& journal) {
  JournalledWork work;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> poses;  // first and count
  journal.for_each([&](JournalPayload payload) {
    switch (payload.take<JournalRecordKind>()) {
      case JournalRecordKind::kCell:
        ++work.cells;
        break;
      case JournalRecordKind::kFinishedPoses: {
        const std::uint64_t first = payload.take_count();
        poses.emplace_back(first, payload.take_count());
        break;
      }
      case JournalRecordKind::kMarks:
      case JournalRecordKind::kProfile:
        break;
      default:
        payload.refuse("of an unknown kind");
    }
  });
  // With another number of threads the poses are divided differently, so some may have been
  // finished twice.
  std::sort(poses.begin(), poses.end());
  std::uint64_t end = 0;
  for (const auto& [first, count] : poses) {
    const std::uint64_t past = first + std::min(count, ~first);
    if (past <= end) continue;
    work.poses += past - std::max(first, end);
    end = past;
  }
  return work;
}

}  // namespace clearway
