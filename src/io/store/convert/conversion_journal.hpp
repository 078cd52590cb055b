#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/messages/messages.hpp"
#include "io/files/file.hpp"
#include "io/files/pending_file.hpp"
#include "io/result/journal.hpp"
#include "io/result/journal_values.hpp"
#include "io/store/convert/convert.hpp"

namespace clearway {

/// How far a conversion came that did not end. Also the first byte of a record of its journal.
enum class ConversionPhase : std::uint8_t {
  kInspected = 1,  ///< which files can be read, and the scale that was chosen
  kCounted,        ///< all that is known once all points were counted
  kDistributed,    ///< what was counted on the way, and what the files of points hold
};

/// The journal beside the output of a conversion: which of its phases an earlier process finished,
/// and those that this one finishes (docs/design/conversion.md).
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

  /// Reads what an earlier process knew at the end of a phase. Returns false where it did not come
  /// to it.
  bool take(ConversionPhase phase, const std::function<void(JournalValues&)>& use) const;
  /// Keeps what is known at the end of a phase.
  void keep(ConversionPhase phase, const std::function<void(JournalValues&)>& what);

  /// Opens the files of points: those of the earlier process where it had distributed all points,
  /// and otherwise this number of empty ones.
  std::vector<File> open_points(std::size_t files);
  /// Where the points begin in their files.
  static constexpr std::uint64_t kPointsBegin = 4096;
  /// Number of files of points beside the output.
  std::size_t point_files() const;

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
  void find_earlier();

  PendingFile& pending_;
  const ConversionOptions& options_;
  MessageLog& log_;
  std::filesystem::path path_;
  bool replaces_;
  std::optional<JournalReader> read_;
  std::optional<JournalWriter> writer_;
  std::string unwanted_;  ///< why an earlier journal is removed; empty where it is kept
  /// The last phase that is finished, by this process or an earlier one
  std::optional<ConversionPhase> finished_;
};

/// The phase in words, as in "all points were counted".
const char* in_words(ConversionPhase phase);

/// Whether an unfinished conversion with this output was to overwrite it.
bool unfinished_overwrites(const std::filesystem::path& output);

/// Removes what an earlier process of the same conversion left beside its output, which is
/// finished. Returns false, and removes nothing, where the journal is that of another conversion.
bool remove_left_over(const ConversionOptions& options);

/// Refuses a conversion of standard input beside the journal of an unfinished one, or removes what
/// that left where options ask to overwrite. pending: the output of both.
void give_way_to_stream(PendingFile& pending, const ConversionOptions& options);

}  // namespace clearway
