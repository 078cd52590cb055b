// Reads what a journal's file holds: checks it record by record and adds it to an answer.
#include <algorithm>
#include <cmath>

#include "core/geometry/predicate.hpp"
#include "core/query/body_numbers.hpp"
#include "stream/each_bit.hpp"
#include "stream/journalled_work.hpp"
#include "stream/search_journal.hpp"

namespace clearway {
namespace {

using enum JournalRecordKind;

/// A range of poses as a payload gives it, which must lie within the first `most` poses.
struct PoseRange {
  PoseRange(JournalPayload& payload, std::uint64_t most)
      : first(payload.take_count()), count(payload.take_count()) {
    if (first > most || count > most - first) {
      payload.refuse("poses past the trajectory's end");
    }
  }
  std::uint64_t first, count;
};

std::uint32_t take_below(JournalPayload& payload, std::uint64_t end) {
  const std::uint64_t pose = payload.take_count();
  if (pose >= end) payload.refuse("a pose past the trajectory's end");
  return static_cast<std::uint32_t>(pose);
}

}  // namespace

void SearchJournal::note_finished() {
  if (read_ == nullptr) return;
  replay_all({});  // checks all records
  read_->for_each([this](JournalPayload payload) {
    const auto kind = payload.take<JournalRecordKind>();
    if (kind == kCell) finished_cells_[take_cell(payload)] = true;
    if (kind == kFinishedPoses) {
      const PoseRange poses(payload, finished_poses_.size());
      const auto begin = finished_poses_.begin() + static_cast<std::ptrdiff_t>(poses.first);
      std::fill_n(begin, poses.count, true);
    }
  });
}

void SearchJournal::replay_all(const Target& target) const {
  if (read_ == nullptr) return;
  read_->for_each([&](JournalPayload payload) {
    switch (payload.take<JournalRecordKind>()) {
      case kCell:
        replay_cell(payload, target.hits, target.clearances);
        break;
      case kProfile:
        replay_profile(payload, target.profile);
        break;
      case kMarks:
        replay_marks(payload, target.hits);
        break;
      case kFinishedPoses:
        PoseRange(payload, query_.poses.size());
        break;
      default:
        payload.refuse("of an unknown kind");
    }
    if (!payload.at_end()) payload.refuse("longer than what it holds");
  });
}

std::uint32_t SearchJournal::take_cell(JournalPayload& payload) const {
  const std::uint64_t cell = payload.take_count();
  if (cell >= cloud_.cells().size()) payload.refuse("a cell that the store does not have");
  return static_cast<std::uint32_t>(cell);
}

std::uint32_t SearchJournal::take_pose(JournalPayload& payload) const {
  return take_below(payload, query_.poses.size());
}

std::uint32_t SearchJournal::take_number(JournalPayload& payload) const {
  return take_below(payload, BodyNumbers(query_).end(query_.poses.size()));
}

/// Takes the bits of a word, which must all be points of the cloud.
std::uint64_t SearchJournal::take_points(JournalPayload& payload, std::uint64_t word) const {
  const auto bits = payload.take<std::uint64_t>();
  const std::uint64_t words_per_cell = cloud_.blocks_per_cell();
  const Cell& cell = cloud_.cells()[word / words_per_cell];
  const std::uint64_t first = word % words_per_cell * kBlockPoints;
  const std::uint64_t points = cell.count > first ? cell.count - first : 0;
  if (bits == 0 || (points < kBlockPoints && bits >> points != 0)) {
    payload.refuse("points that the store does not have");
  }
  return bits;
}

/// Whether this can be the square of a distance, which stands below 0 for a point inside solids.
bool SearchJournal::is_square(double squared) const {
  return squared >= 0 || (has_solids(query_) && squared < 0 && std::isfinite(squared));
}

void SearchJournal::replay_cell(JournalPayload& payload, HitSet* hits,
                                ClearanceSet* clearances) const {
  const std::uint64_t cell_word = std::uint64_t{take_cell(payload)} * cloud_.blocks_per_cell();
  const auto for_each_word = [&](auto visit) {
    std::uint64_t next = 0;
    for (std::uint64_t words = payload.take_count(); words > 0; --words) {
      const std::uint64_t skipped = payload.take_count();
      if (skipped >= cloud_.blocks_per_cell() - next) payload.refuse("a block past its cell's end");
      const std::uint64_t word = cell_word + next + skipped;
      visit(word, take_points(payload, word));
      next += skipped + 1;
    }
  };
  for_each_word([&](std::uint64_t word, std::uint64_t bits) {
    if (hits != nullptr) hits->mark_word(word, bits);
    if (!query_.first_pose) return;
    for_each_bit(bits, [&](std::size_t i) {
      const std::uint32_t number = take_number(payload);
      if (hits != nullptr) hits->mark(word * kBlockPoints + i, number);
    });
  });
  if (!(query_.clearance > 0)) return;
  for_each_word([&](std::uint64_t word, std::uint64_t bits) {
    for_each_bit(bits, [&](std::size_t i) {
      const auto squared = payload.take<double>();
      const Clearance clearance{squared, take_number(payload)};
      if (!(is_square(squared) && clearance.found())) payload.refuse("a distance that is none");
      if (clearances != nullptr) clearances->set(word * kBlockPoints + i, clearance);
    });
  });
}

void SearchJournal::replay_marks(JournalPayload& payload, HitSet* hits) const {
  const std::uint64_t words = cloud_.entry_count() / kBlockPoints;
  std::uint64_t word = 0;
  for (std::uint64_t marks = payload.take_count(); marks > 0; --marks) {
    const std::uint64_t skipped = payload.take_count();
    if (skipped >= words - word) payload.refuse("a block that the store does not have");
    word += skipped;
    const std::uint64_t bits = take_points(payload, word);
    if (!query_.first_pose) {
      if (hits != nullptr) hits->mark_word(word, bits);
      continue;
    }
    const std::uint32_t pose = take_pose(payload);
    if (hits == nullptr) continue;
    for_each_bit(bits, [&](std::size_t i) { hits->mark(word * kBlockPoints + i, pose); });
  }
}

void SearchJournal::replay_profile(JournalPayload& payload, ProfileSet* profile) const {
  if (!(query_.profile > 0)) payload.refuse("of a profile that was not asked for");
  const double limit = rounded_product(query_.profile, query_.profile);
  for (std::uint64_t facts = payload.take_count(); facts > 0; --facts) {
    const std::uint32_t pose = take_pose(payload);
    const auto squared = payload.take<double>();
    if (!(is_square(squared) && squared < limit)) payload.refuse("a distance that is none");
    const std::uint64_t entry = payload.take_count();
    const std::uint64_t cell = entry / cloud_.cell_entries(), index = entry % cloud_.cell_entries();
    if (cell >= cloud_.cells().size() || index >= cloud_.cells()[cell].count) {
      payload.refuse("a point that the store does not have");
    }
    if (profile == nullptr) continue;
    const std::uint64_t source =
        cloud_.source_of(static_cast<std::uint32_t>(cell), static_cast<std::uint32_t>(index));
    profile->offer(pose, {squared, source, entry});
  }
}

}  // namespace clearway
