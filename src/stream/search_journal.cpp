#include "stream/search_journal.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/geometry/predicate.hpp"
#include "core/query/body_numbers.hpp"
#include "core/util/lane_bits.hpp"
#include "stream/run_pages.hpp"

namespace clearway {

JournalledWork journalled_work(const JournalReader& journal) {
  JournalledWork work;
  if (journal.identity() && is_of_conversion(*journal.identity())) return work;
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

namespace {

using enum JournalRecordKind;

constexpr std::uint64_t kMostCountBytes = 10;

/// Greatest number of a profile's facts in one record.
constexpr std::size_t kMostFacts = 4096;

std::uint64_t bit_of(std::size_t index) { return std::uint64_t{1} << index; }

/// Puts the words that are not 0, each with its distance from the one before. For each of its
/// points put_point(i) follows.
template <typename WordAt, typename PutPoint>
void put_words(JournalRecord& record, std::size_t words, WordAt word_at, PutPoint put_point) {
  std::uint64_t count = 0;
  for (std::size_t word = 0; word < words; ++word) count += word_at(word) != 0;
  record.put_count(count);
  std::size_t next = 0;
  for (std::size_t word = 0; word < words; ++word) {
    const std::uint64_t bits = word_at(word);
    if (bits == 0) continue;
    record.put_count(word - next);
    record.put(bits);
    for_each_bit(bits, [&](std::uint32_t i) { put_point(word * kBlockPoints + i); });
    next = word + 1;
  }
}

void put_clearances(JournalRecord& record, std::span<const Clearance> clearances) {
  const auto word_at = [&](std::size_t word) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < kBlockPoints; ++i) {
      if (clearances[word * kBlockPoints + i].found()) bits |= bit_of(i);
    }
    return bits;
  };
  put_words(record, clearances.size() / kBlockPoints, word_at, [&](std::size_t point) {
    record.put(clearances[point].squared);
    record.put_count(clearances[point].pose);
  });
}

}  // namespace

SearchJournal::SearchJournal(std::filesystem::path path, JournalIdentity identity,
                             const JournalReader* read, const PackedCloud& cloud,
                             const Query& query, double interval_seconds)
    : cloud_(cloud),
      query_(query),
      read_(read),
      finished_cells_(cloud.cells().size()),
      finished_poses_(query.poses.size()),
      path_(std::move(path)),
      identity_(std::move(identity)),
      interval_seconds_(interval_seconds) {
  note_finished();
}

bool SearchJournal::poses_finished(std::uint32_t first, std::uint32_t count) const {
  const auto begin = finished_poses_.begin() + first;
  return std::find(begin, begin + count, false) == begin + count;
}

void SearchJournal::append(JournalRecord& record) {
  {
    const std::lock_guard lock(mutex_);
    if (!writer_) {
      writer_.emplace(read_ != nullptr
                          ? JournalWriter::resume(path_, *read_, interval_seconds_)
                          : JournalWriter::create(path_, identity_, interval_seconds_));
    }
  }
  writer_->append(record);
}

bool SearchJournal::is_in_place() const {
  if (writer_) return writer_->file().is_at(path_);
  return read_ != nullptr && read_->file().is_at(path_);
}

/// Appends the facts of a page in records of a bounded size, before its cells count as finished.
/// Facts that another page has bettered are left out: if that page is not finished, it is searched
/// again, and the best fact is always kept.
void SearchJournal::append_profile(std::span<const PlannedCell> cells,
                                   std::span<const ProfileFact> facts, const ProfileSet& profile) {
  std::vector<const ProfileFact*> held;
  held.reserve(std::min(facts.size(), kMostFacts));
  while (!facts.empty()) {
    held.clear();
    for (; !facts.empty() && held.size() < kMostFacts; facts = facts.subspan(1)) {
      const ProfileFact& fact = facts.front();
      if (profile.holds(fact.pose, entry_of(cloud_, cells, fact.point))) held.push_back(&fact);
    }
    if (held.empty()) return;
    JournalRecord record;
    record.put(kProfile);
    record.put_count(held.size());
    for (const ProfileFact* fact : held) {
      record.put_count(fact->pose);
      record.put(fact->squared);
      record.put_count(entry_of(cloud_, cells, fact->point));
    }
    append(record);
  }
}

void SearchJournal::append_page(std::span<const PlannedCell> cells, const PageResult& answer,
                                const ProfileSet& profile) {
  append_profile(cells, answer.profile, profile);
  JournalRecord record;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto hits = part_of_cell(answer.hits, i, cloud_.blocks_per_cell());
    const auto poses = part_of_cell(answer.first_poses, i, cloud_.cell_entries());
    record.put(kCell);
    record.put_count(cells[i].cell);
    put_words(
        record, hits.size(), [&](std::size_t word) { return hits[word]; },
        [&](std::size_t point) {
          if (!poses.empty()) record.put_count(poses[point]);
        });
    if (query_.clearance > 0) {
      put_clearances(record, part_of_cell(answer.clearances, i, cloud_.cell_entries()));
    }
    append(record);
  }
}

void SearchJournal::append_marks(std::span<PoseMark> marks) {
  const auto key = [this](const PoseMark& mark) {
    return std::pair(mark.word, query_.first_pose ? mark.pose : 0);
  };
  std::sort(marks.begin(), marks.end(),
            [&](const PoseMark& a, const PoseMark& b) { return key(a) < key(b); });
  std::size_t merged = 0;  // number of marks after those of the same word and pose are merged
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (merged > 0 && key(marks[merged - 1]) == key(marks[i])) {
      marks[merged - 1].bits |= marks[i].bits;
    } else {
      marks[merged++] = marks[i];
    }
  }
  JournalRecord record;
  record.put(kMarks);
  record.put_count(merged);
  std::uint64_t word = 0;
  for (const PoseMark& mark : marks.first(merged)) {
    record.put_count(mark.word - word);
    record.put(mark.bits);
    if (query_.first_pose) record.put_count(mark.pose);
    word = mark.word;
  }
  append(record);
}

void SearchJournal::append_finished_poses(std::uint32_t first, std::uint32_t count) {
  JournalRecord record;
  record.put(kFinishedPoses);
  record.put_count(first);
  record.put_count(count);
  append(record);
}

std::uint64_t SearchJournal::most_bytes(const PackedCloud& cloud, const Query& query, int threads) {
  constexpr std::uint64_t kWordBytes = kMostCountBytes + sizeof(std::uint64_t);
  constexpr std::uint64_t kPoseBytes = 5;
  const bool clearance = query.clearance > 0;
  const std::uint64_t block =
      kWordBytes + (query.first_pose ? kBlockPoints * kPoseBytes : 0) +
      (clearance ? kWordBytes + kBlockPoints * (sizeof(double) + kPoseBytes) : 0);
  constexpr std::uint64_t kRecordBytes = 64;
  // A vector that grows exists twice for a moment, and the new one is twice as large.
  const std::uint64_t of_profile =
      query.profile > 0
          ? kMostFacts * (sizeof(void*) + 3 * (sizeof(double) + kPoseBytes + kMostCountBytes))
          : 0;
  const std::uint64_t record =
      std::max(3 * (kRecordBytes + cloud.blocks_per_cell() * block), of_profile);
  return static_cast<std::uint64_t>(threads) * record +
         (cloud.cells().size() + query.poses.size()) / 8;
}

}  // namespace clearway

// Reads what a journal's file holds: checks it record by record and adds it to an answer.

namespace clearway {
namespace {

using enum JournalRecordKind;

/// A range of poses as a payload gives it, which must lie within the first `most` poses.
struct TakenPoses {
  TakenPoses(JournalPayload& payload, std::uint64_t most)
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
      const TakenPoses poses(payload, finished_poses_.size());
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
        TakenPoses(payload, query_.poses.size());
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
    for_each_bit(bits, [&](std::uint32_t i) {
      const std::uint32_t number = take_number(payload);
      if (hits != nullptr) hits->mark(word * kBlockPoints + i, number);
    });
  });
  if (!(query_.clearance > 0)) return;
  for_each_word([&](std::uint64_t word, std::uint64_t bits) {
    for_each_bit(bits, [&](std::uint32_t i) {
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
    for_each_bit(bits, [&](std::uint32_t i) { hits->mark(word * kBlockPoints + i, pose); });
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
