#pragma once

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
#include "core/query/pose_journal.hpp"
#include "core/query/search_result.hpp"
#include "io/result/journal.hpp"

namespace clearway {

/// The kind of a record in a search's journal; its first byte.
enum class JournalRecordKind : std::uint8_t {
  kCell = 1,
  kMarks = 2,
  kFinishedPoses = 3,
  kProfile = 4
};

/// How much of a run a journal holds. Throws InputError for a record that is not of a run.
struct JournalledWork {
  std::uint64_t cells = 0;  ///< finished cells, for engines that work on pages
  std::uint64_t poses = 0;
};
JournalledWork journalled_work(const JournalReader& journal);

/// The answer of a run as far as it is known, in a journal file: cell by cell from engines that
/// work on pages, marks and finished poses from other engines (docs/design/journal.md).
class SearchJournal final : public PoseJournal {
 public:
  /// Begins a new file, which the first append creates, or continues the one that `read` has read.
  /// Throws InputError naming the first record that cannot belong to this cloud and query. All
  /// arguments but path and identity must outlive this object.
  SearchJournal(std::filesystem::path path, JournalIdentity identity, const JournalReader* read,
                const PackedCloud& cloud, const Query& query, double interval_seconds);

  /// Adds what the file held to `answer`, which must be of the same cloud and query.
  void restore(SearchResult& answer) const {
    replay_all({&answer.hits, &answer.clearances, &answer.profile});
  }
  bool cell_finished(std::uint32_t cell) const { return finished_cells_[cell]; }

  /// Appends the answer of a page of these cells, after `profile` has taken it in. Thread safe.
  void append_page(std::span<const PlannedCell> cells, const PageResult& answer,
                   const ProfileSet& profile);

  // PoseJournal
  void restore(HitSet& hits) const override { replay_all({&hits, nullptr, nullptr}); }
  bool poses_finished(std::uint32_t first, std::uint32_t count) const override;
  void append_marks(std::span<PoseMark> marks) override;
  void append_finished_poses(std::uint32_t first, std::uint32_t count) override;

  /// Whether the file at this journal's path still is this journal. Must not be called while others
  /// append.
  bool is_in_place() const;

  /// Greatest memory, in bytes, while `threads` threads append at once.
  static std::uint64_t most_bytes(const PackedCloud& cloud, const Query& query, int threads);

 private:
  /// The sets that records are added to; null for those whose records are only checked.
  struct Target {
    HitSet* hits = nullptr;
    ClearanceSet* clearances = nullptr;
    ProfileSet* profile = nullptr;
  };

  void note_finished();
  void append(JournalRecord& record);
  void append_profile(std::span<const PlannedCell> cells, std::span<const ProfileFact> facts,
                      const ProfileSet& profile);
  void replay_all(const Target& target) const;
  bool is_square(double squared) const;
  void replay_cell(JournalPayload& payload, HitSet* hits, ClearanceSet* clearances) const;
  void replay_profile(JournalPayload& payload, ProfileSet* profile) const;
  void replay_marks(JournalPayload& payload, HitSet* hits) const;
  std::uint32_t take_cell(JournalPayload& payload) const;
  std::uint32_t take_pose(JournalPayload& payload) const;
  /// Reads a pose and a body, encoded as BodyNumbers does.
  std::uint32_t take_number(JournalPayload& payload) const;
  std::uint64_t take_points(JournalPayload& payload, std::uint64_t word) const;

  const PackedCloud& cloud_;
  const Query& query_;
  const JournalReader* read_;
  std::vector<bool> finished_cells_;
  std::vector<bool> finished_poses_;
  std::filesystem::path path_;
  JournalIdentity identity_;
  double interval_seconds_;
  std::mutex mutex_;
  std::optional<JournalWriter> writer_;
};

}  // namespace clearway
