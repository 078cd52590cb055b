#include "stream/search_journal.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "stream/collect_page.hpp"
#include "stream/each_bit.hpp"
#include "stream/journalled_work.hpp"

namespace clearway {
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
    for_each_bit(bits, [&](std::size_t i) { put_point(word * kBlockPoints + i); });
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
