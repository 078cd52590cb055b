#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/messages/messages.hpp"
#include "io/files/file.hpp"
#include "io/files/pending_file.hpp"
#include "io/result/journal.hpp"
#include "io/result/journal_values.hpp"
#include "io/store/convert/convert.hpp"
#include "io/store/convert/distribute.hpp"
#include "io/store/convert/environment_source.hpp"
#include "io/store/store_writer.hpp"

namespace clearway {

/// What a journal keeps of a cell once it is in the store that is being written.
struct WrittenCell {
  Cell cell{};
  std::vector<BlockBox> blocks;
  std::vector<ChunkPlace> chunks;  ///< as StoreWriter::append() returns them

  template <typename Values>
  void keep(Values& values) {
    values.add(cell, blocks, chunks);
  }
};

/// The journal beside the output of a conversion: what an earlier process left there, and what this
/// one keeps (docs/design/conversion.md).
class ConversionJournal {
 public:
  /// Looks for an earlier journal. Throws UsageError where there is one of other inputs or options,
  /// or one that options ask neither to resume nor to overwrite, and InputError where it is
  /// damaged. The output belongs to this process alone. All references outlive it.
  ConversionJournal(PendingFile& pending, const ConversionOptions& options, MessageLog& log);
  ConversionJournal(const ConversionJournal&) = delete;
  ConversionJournal& operator=(const ConversionJournal&) = delete;

  /// Whether an earlier process left work that this one takes over.
  bool resumes() const { return read_.has_value(); }

  /// Whether the conversion overwrites an existing output.
  bool replaces() const { return replaces_; }

  /// What the earlier process found in the inputs, or null.
  const FoundInputs* found() const { return found_ ? &*found_ : nullptr; }
  void keep_found(FoundInputs found);

  // The counting pass.

  /// Whether it is time to keep what has been counted. Where it is, the pass pauses for
  /// keep_counted_part().
  bool wants_counted();
  /// Reads what was counted before the end of the pass. Returns false where nothing was kept.
  bool take_counted_part(const std::function<void(JournalValues&)>& take);
  void keep_counted_part(const std::function<void(JournalValues&)>& keep);
  /// Reads what was known after the pass. Returns false where it had not come to its end.
  bool take_counted(const std::function<void(JournalValues&)>& take);
  void keep_counted(const std::function<void(JournalValues&)>& keep);

  /// Notes that work on a batch of the current pass begins; they are numbered from 1.
  void begin_batch(std::uint64_t number);
  /// Notes that the current pass goes on after this many batches. What the earlier process had
  /// begun with after them is done again.
  void go_on_after_batches(std::uint64_t batches);

  // The distribution.

  /// Opens the files of points; where there are none yet, this number of them is made.
  std::vector<File> open_points(std::size_t files);
  /// Where the points begin in their files.
  static constexpr std::uint64_t kPointsBegin = 4096;
  bool has_points() const { return files_ > 0; }
  /// The batches that are distributed; of their hashes, only the last one has those of all points.
  /// None once the distribution is complete.
  const std::vector<DistributedBatch>& batches() const { return batches_; }
  /// Bytes of memory that the batches occupy, and those that it takes to check them.
  std::uint64_t bytes_of_batches() const;
  /// Forgets all but the first batches, because the files do not hold the others.
  void cut_batches(std::size_t batches);
  void keep_batch(DistributedBatch& batch);
  bool is_distributed() const { return distributed_.has_value(); }
  /// Reads what was known after the distribution.
  void take_distributed(const std::function<void(JournalValues&)>& take);
  void keep_distributed(const std::function<void(JournalValues&)>& keep);

  // The store's units.

  /// Number of units that were written.
  std::size_t units() const { return units_.size(); }
  std::uint64_t written_cells() const { return written_cells_; }
  /// Opens the file that holds them, and checks them in parallel. Units that it does not hold as
  /// they were written are forgotten, together with those after them.
  void check_units();
  /// Calls use(cell) for each cell that was written, in order, with its chunks as they are in that
  /// file; afterwards the file is removed.
  void for_each_cell(const StoreMetadata& metadata,
                     const std::function<void(const PackedCell&)>& use);
  void begin_unit(std::uint64_t number);
  void keep_unit(std::vector<WrittenCell>& cells);

  // What the earlier process had begun with and not finished, so that it is done again.
  std::uint64_t recounted_batches() const { return recounted_batches_; }
  std::uint64_t repeated_batches() const { return repeated_batches_; }
  std::uint64_t repeated_units() const { return repeated_units_; }

  /// Removes the files that are of no use once the store is complete, but not the journal.
  void remove_points();
  /// Removes the journal. The output's lock ended with its publication, so another process may have
  /// begun since; that process's journal is left alone.
  void remove_after_publication();
  /// Leaves everything for a later process, and says so, or removes everything where nothing was
  /// finished.
  void leave();
  /// Removes everything.
  void discard();

 private:
  using Place = std::uint64_t;  ///< number of a record

  void find_earlier();
  void read_record(JournalPayload payload, Place place);
  bool take(std::optional<Place> place, const std::function<void(JournalValues&)>& use) const;
  void take_last_hashes();
  void forget_batches();
  void for_each_unit(const std::function<void(std::vector<WrittenCell>&)>& use) const;
  void append(JournalRecord& record);
  void keep(int kind, const std::function<void(JournalValues&)>& what);
  std::filesystem::path points_path(std::size_t file) const;
  std::filesystem::path aside_path() const;
  void remove_points_from(std::size_t file);
  std::string work_text() const;
  bool has_work() const;

  PendingFile& pending_;
  const ConversionOptions& options_;
  MessageLog& log_;
  std::filesystem::path path_;
  JournalIdentity identity_;
  bool replaces_;
  std::optional<JournalReader> read_;
  std::optional<JournalWriter> writer_;
  std::string unwanted_;  ///< why an earlier journal is removed; empty where it is kept

  std::optional<FoundInputs> found_;
  std::optional<Place> counted_part_, counted_, distributed_;
  std::size_t files_ = 0;  ///< number of files of points; 0 where there are none yet
  std::vector<DistributedBatch> batches_;
  std::vector<Place> places_of_batches_;
  std::uint64_t distributed_records_ = 0;
  std::vector<Place> units_;
  std::uint64_t written_bytes_ = 0;  ///< end of the last chunk that was written
  std::uint64_t written_cells_ = 0;
  std::uint64_t begun_batches_ = 0, begun_units_ = 0;
  std::uint64_t recounted_batches_ = 0, repeated_batches_ = 0, repeated_units_ = 0;
  std::optional<File> written_;
  using Clock = std::chrono::steady_clock;
  Clock::time_point begun_at_ = Clock::now(), counted_at_ = begun_at_, paused_at_ = begun_at_;
};

/// Whether an unfinished conversion with this output was to overwrite it.
bool unfinished_overwrites(const std::filesystem::path& output);

/// Removes what an earlier process of the same conversion left beside its output, which is
/// finished. Returns false, and removes nothing, where the journal is that of another conversion.
bool remove_left_over(const ConversionOptions& options);

/// Refuses a conversion of standard input beside the journal of an unfinished one, or removes what
/// that left where options ask to overwrite. pending: the output of both.
void give_way_to_stream(PendingFile& pending, const ConversionOptions& options);

}  // namespace clearway
