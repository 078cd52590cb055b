#include "stream/search_journal.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/geometry/predicate.hpp"
#include "stream/run_pages.hpp"

namespace clearway {

std::array<std::uint64_t, kQuestions> answered_cells(const JournalReader& journal) {
  std::array<std::uint64_t, kQuestions> cells{};
  if (journal.identity() && is_of_conversion(*journal.identity())) return cells;
  journal.for_each([&](JournalPayload payload) {
    switch (payload.take<JournalRecordKind>()) {
      case JournalRecordKind::kCell:
        for (const PointQuestion question : questions_in(payload)) {
          ++cells[index_of(question)];
        }
        break;
      case JournalRecordKind::kProfile:
        break;
      default:
        payload.refuse("of an unknown kind");
    }
  });
  return cells;
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
      path_(std::move(path)),
      identity_(std::move(identity)),
      interval_seconds_(interval_seconds),
      rows_(cloud, query, *this) {
  if (read_ == nullptr) return;
  read_->for_each([this](JournalPayload payload) {
    JournalPayload rest = payload;
    switch (rest.take<JournalRecordKind>()) {
      case kCell:
        rows_.note(payload, payload.place());
        break;
      case kProfile:
        take_profile(rest, nullptr);
        break;
      default:
        rest.refuse("of an unknown kind");
    }
  });
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

std::uint64_t SearchJournal::most_bytes(const PackedCloud& cloud, const Query& query, int threads) {
  constexpr std::uint64_t kPoseBytes = 5;
  // A vector that grows exists twice for a moment, and the new one is twice as large.
  const std::uint64_t of_profile =
      query.profile > 0
          ? kMostFacts *
                (sizeof(void*) + 3 * (sizeof(double) + kPoseBytes + JournalRecord::kMostCountBytes))
          : 0;
  const std::uint64_t record = std::max(AnswerRows::most_cell_bytes(cloud, query), of_profile);
  return static_cast<std::uint64_t>(threads) * record;
}

CollectPage keep_answer(const PackedCloud& cloud, AnswerRows& rows, ProfileSet& profile,
                        SearchJournal* journal, FurtherRows further) {
  return [&cloud, &rows, &profile, journal, further = std::move(further)](
             std::span<const PlannedCell> cells, const PageResult& found) {
    offer_profile(cloud, cells, found.profile, profile);
    if (journal != nullptr) journal->append_profile(cells, found.profile, profile);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      std::vector<AnswerRows::Part> parts;  // not from a list, which would copy the rows
      parts.push_back({PointQuestion::kHits, hit_rows(cloud, found, i)});
      if (rows.asks(PointQuestion::kClearances)) {
        parts.push_back({PointQuestion::kClearances, clearance_rows(cloud, found, i)});
      }
      if (further) further(cells[i].cell, found, i, parts);
      rows.add(cells[i].cell, parts);
    }
  };
}

void SearchJournal::restore(ProfileSet& profile) const {
  if (read_ == nullptr) return;
  read_->for_each([&](JournalPayload payload) {
    if (payload.take<JournalRecordKind>() == kProfile) take_profile(payload, &profile);
  });
}

void SearchJournal::take_profile(JournalPayload payload, ProfileSet* profile) const {
  if (!(query_.profile > 0)) payload.refuse("of a profile that was not asked for");
  const double limit = rounded_product(query_.profile, query_.profile);
  for (std::uint64_t facts = payload.take_count(); facts > 0; --facts) {
    const std::uint64_t pose = payload.take_count();
    if (pose >= query_.poses.size()) payload.refuse("a pose past the trajectory's end");
    const auto squared = payload.take<double>();
    if (!(is_square(query_, squared) && squared < limit)) payload.refuse("a distance that is none");
    const std::uint64_t entry = payload.take_count();
    const std::uint64_t cell = entry / cloud_.cell_entries(), index = entry % cloud_.cell_entries();
    if (cell >= cloud_.cells().size() || index >= cloud_.cells()[cell].count) {
      payload.refuse("a point that the store does not have");
    }
    if (profile != nullptr) profile->offer(static_cast<std::uint32_t>(pose), squared, entry);
  }
  if (!payload.at_end()) payload.refuse("longer than what it holds");
}

}  // namespace clearway
