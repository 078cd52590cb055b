#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "clearway/search.hpp"
#include "core/messages/messages.hpp"
#include "core/util/progress.hpp"
#include "io/files/pending_file.hpp"
#include "io/result/journal.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"
#include "stream/search_journal.hpp"

namespace clearway {

/// The journal beside the output of a search: the one that an earlier run left there, and the one
/// that this run keeps.
class RunJournal {
 public:
  /// Looks for an earlier journal. Throws UsageError, saying what was found and what to do, where
  /// there is one and options ask neither to resume nor to overwrite. The output belongs to this
  /// process alone. All references outlive it; pending is for the path `output`.
  RunJournal(PendingFile& pending, const std::filesystem::path& output,
             const SearchOptions& options, MessageLog& log);

  /// Whether, with options.resume, the output exists, is intact, and answers this query: exactly,
  /// or from an earlier run that was only kept from removing its journal. In that case a journal is
  /// removed. Throws as refuse_existing() where another output exists.
  bool already_done(const StoreReader& store, const ResultHeader& header, Progress& progress);

  /// Throws UsageError where there is an output that this run may not overwrite. The message says
  /// whether the output answers this query or which inputs and parameters differ, because whoever
  /// reads the output next would take its answer for that of this run.
  void refuse_existing(const ResultHeader& header) const;

  /// The device of the run that is resumed; kAuto where there is none.
  Device earlier_device() const;

  /// Opens the journal for this query, engine and device, in which the answer is kept. An earlier
  /// journal is removed where options ask to overwrite or nothing is in it. Throws UsageError,
  /// naming what differs, where the earlier journal belongs to another run.
  SearchJournal& open(const StoreReader& store, const Query& query, const ResultHeader& header,
                      Engine engine, Device device);

  /// Removes the journal. The output's lock ended with its publication, so another process may have
  /// begun since; that process's journal is left alone.
  void remove_after_publication();

  const std::filesystem::path& output() const { return output_; }

  /// The cells whose colliding points the earlier run's journal holds.
  std::uint64_t earlier_cells() const { return earlier_cells_; }

 private:
  bool is_of(const StoreReader& store, const ResultHeader& header) const;
  void refuse_other_part(const ResultHeader& header) const;

  PendingFile& pending_;
  const std::filesystem::path& output_;
  const SearchOptions& options_;
  MessageLog& log_;
  std::filesystem::path path_;
  std::optional<JournalReader> read_;
  std::uint64_t earlier_cells_ = 0;
  /// Why the journal that exists is to be removed; empty where it is to be kept.
  std::string unwanted_;
  bool replaces_;  ///< whether this run overwrites an existing output
  std::optional<SearchJournal> results_;
};

}  // namespace clearway
