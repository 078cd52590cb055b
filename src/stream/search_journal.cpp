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
        for (const PointQuestion question : questions_in(payload)) {
          ++work.of_questions[static_cast<std::size_t>(question)];
        }
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
  work.cells = work.of_questions[static_cast<std::size_t>(PointQuestion::kHits)];
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

/// Greatest number of a profile's facts in one record.
constexpr std::size_t kMostFacts = 4096;

}  // namespace

SearchJournal::SearchJournal(std::filesystem::path path, JournalIdentity identity,
                             const JournalReader* read, const PackedCloud& cloud,
                             const Query& query, double interval_seconds)
    : cloud_(cloud),
      query_(query),
      read_(read),
      finished_poses_(query.poses.size()),
      path_(std::move(path)),
      identity_(std::move(identity)),
      interval_seconds_(interval_seconds),
      rows_(cloud, query, *this) {
  note_finished();
}

bool SearchJournal::poses_finished(std::uint32_t first, std::uint32_t count) const {
  const auto begin = finished_poses_.begin() + first;
  return std::find(begin, begin + count, false) == begin + count;
}

std::uint64_t SearchJournal::append(JournalRecord& record) {
  {
    const std::lock_guard lock(mutex_);
    if (!writer_) {
      writer_.emplace(read_ != nullptr
                          ? JournalWriter::resume(path_, *read_, interval_seconds_)
                          : JournalWriter::create(path_, identity_, interval_seconds_));
    }
  }
  return writer_->append(record);
}

JournalPayload SearchJournal::read(std::uint64_t place, std::vector<std::byte>& bytes) const {
  const bool is_earlier = read_ != nullptr && place < read_->whole_bytes();
  return read_record(is_earlier ? read_->file() : writer_->file(), place, bytes);
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
  constexpr std::uint64_t kPoseBytes = 5;
  // A vector that grows exists twice for a moment, and the new one is twice as large.
  const std::uint64_t of_profile =
      query.profile > 0
          ? kMostFacts *
                (sizeof(void*) + 3 * (sizeof(double) + kPoseBytes + JournalRecord::kMostCountBytes))
          : 0;
  const std::uint64_t record = std::max(AnswerRows::most_cell_bytes(cloud, query), of_profile);
  return static_cast<std::uint64_t>(threads) * record + query.poses.size() / 8;
}

CollectPage keep_answer(const PackedCloud& cloud, AnswerRows& rows, ProfileSet& profile,
                        SearchJournal* journal) {
  return [&cloud, &rows, &profile, journal](std::span<const PlannedCell> cells,
                                            const PageResult& found) {
    offer_profile(cloud, cells, found.profile, profile);
    if (journal != nullptr) journal->append_profile(cells, found.profile, profile);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const CellRows hits = hit_rows(cloud, found, i);
      if (!rows.asks(PointQuestion::kClearances)) {
        rows.add(cells[i].cell, {{PointQuestion::kHits, hits}});
        continue;
      }
      const CellRows clearances = clearance_rows(cloud, found, i);
      rows.add(cells[i].cell,
               {{PointQuestion::kHits, hits}, {PointQuestion::kClearances, clearances}});
    }
  };
}

}  // namespace clearway

// Reads what a journal's file holds: checks it record by record.

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

}  // namespace

void SearchJournal::note_finished() {
  if (read_ == nullptr) return;
  replay(nullptr, nullptr);  // checks all other records
  read_->for_each([this](JournalPayload payload) {
    JournalPayload rest = payload;
    const auto kind = rest.take<JournalRecordKind>();
    if (kind == kCell) rows_.note(payload, payload.place());
    if (kind == kFinishedPoses) {
      const TakenPoses poses(rest, finished_poses_.size());
      const auto begin = finished_poses_.begin() + static_cast<std::ptrdiff_t>(poses.first);
      std::fill_n(begin, poses.count, true);
    }
  });
}

void SearchJournal::replay(HitSet* hits, ProfileSet* profile) const {
  if (read_ == nullptr) return;
  read_->for_each([&](JournalPayload payload) {
    switch (payload.take<JournalRecordKind>()) {
      case kCell:
        return;
      case kProfile:
        replay_profile(payload, profile);
        break;
      case kMarks:
        replay_marks(payload, hits);
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

std::uint32_t SearchJournal::take_pose(JournalPayload& payload) const {
  const std::uint64_t pose = payload.take_count();
  if (pose >= query_.poses.size()) payload.refuse("a pose past the trajectory's end");
  return static_cast<std::uint32_t>(pose);
}

void SearchJournal::replay_marks(JournalPayload& payload, HitSet* hits) const {
  const std::uint64_t words = cloud_.entry_count() / kBlockPoints;
  const std::uint64_t words_per_cell = cloud_.blocks_per_cell();
  std::uint64_t word = 0;
  for (std::uint64_t marks = payload.take_count(); marks > 0; --marks) {
    const std::uint64_t skipped = payload.take_count();
    if (skipped >= words - word) payload.refuse("a block that the store does not have");
    word += skipped;
    const std::uint64_t bits =
        take_points(payload, cloud_.cells()[word / words_per_cell], word % words_per_cell);
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
    if (!(is_square(query_, squared) && squared < limit)) payload.refuse("a distance that is none");
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
