#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"
#include "core/query/search_result.hpp"
#include "io/result/journal.hpp"
#include "stream/answer_rows.hpp"
#include "stream/run_pages.hpp"

namespace clearway {

/// How many cells each question has been answered for in the journal of a run. Throws InputError
/// for a record that is not of a run; none are of the journal of a conversion.
std::array<std::uint64_t, kQuestions> answered_cells(const JournalReader& journal);

/// The answer of a run as far as it is known, in a journal file: rows cell by cell, and the nearest
/// points of a profile (docs/design/journal.md).
class SearchJournal final : public RowStorage {
 public:
  /// Begins a new file, which the first append creates, or continues the one that `read` has read.
  /// Throws InputError naming the first record that cannot belong to this cloud and query. All
  /// arguments but path and identity must outlive this object.
  SearchJournal(std::filesystem::path path, JournalIdentity identity, const JournalReader* read,
                const PackedCloud& cloud, const Query& query, double interval_seconds);

  /// What is known, with what the file held.
  AnswerRows& rows() { return rows_; }
  const AnswerRows& rows() const { return rows_; }

  /// Adds the points of a profile that the file held.
  void restore(ProfileSet& profile) const;
  /// Appends the facts of a page of these cells, after `profile` has taken them in and before the
  /// cells are added to the rows. Thread safe.
  void append_profile(std::span<const PlannedCell> cells, std::span<const ProfileFact> facts,
                      const ProfileSet& profile);

  // RowStorage
  std::uint64_t keep(JournalRecord& record) override { return append(record); }
  JournalPayload read(std::uint64_t place, std::vector<std::byte>& bytes) const override;

  /// Whether the file at this journal's path still is this journal. Must not be called while others
  /// append.
  bool is_in_place() const;

  /// Greatest memory, in bytes, while `threads` threads append at once.
  static std::uint64_t most_bytes(const PackedCloud& cloud, const Query& query, int threads);

 private:
  std::uint64_t append(JournalRecord& record);
  /// Checks a record of a profile's points after its kind, and adds them to a profile that is not
  /// null.
  void take_profile(JournalPayload payload, ProfileSet* profile) const;

  const PackedCloud& cloud_;
  const Query& query_;
  const JournalReader* read_;
  std::filesystem::path path_;
  JournalIdentity identity_;
  double interval_seconds_;
  std::mutex mutex_;
  std::optional<JournalWriter> writer_;
  AnswerRows rows_;
};

/// Further rows of cell `index` of a page, which are kept in the record of its hits.
using FurtherRows = std::function<void(std::uint32_t cell, const PageResult& page,
                                       std::size_t index, std::vector<AnswerRows::Part>& parts)>;

/// Keeps the answer of pages: in `profile` the nearest points, then in `rows` what was found in
/// each cell. journal: gets the nearest points, too; null where there is none. further: adds to the
/// rows of a cell; null where there is nothing to add. All outlive the function.
CollectPage keep_answer(const PackedCloud& cloud, AnswerRows& rows, ProfileSet& profile,
                        SearchJournal* journal, FurtherRows further = nullptr);

}  // namespace clearway
