#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "cli/run_options.hpp"
#include "core/util/progress.hpp"
#include "io/journal/journal.hpp"
#include "io/result/result.hpp"
#include "io/system/pending_file.hpp"
#include "stream/search_journal.hpp"

namespace clearway::tool {

/// The journal beside the output of `clearway run`: what an earlier run left there, and what this
/// one keeps.
class RunJournal {
 public:
  /// Looks for an earlier journal. Throws UsageError, saying what was found and what to do, where
  /// there is one and neither options.resume nor options.force.
  /// The output is this process's alone; output and options outlive it.
  RunJournal(PendingFile& output, const RunOptions& options);

  /// Whether, with options.resume, the output is there, intact, and answers this query: exactly,
  /// or from an earlier run that was only kept from removing its journal. A journal is removed
  /// then. Throws UsageError where another output is there that this run may not overwrite.
  bool already_done(const StoreReader& store, const ResultHeader& header, Progress& progress);

  /// "cpu" or "cuda", as the run to resume was started with; empty where there is none.
  std::string earlier_device() const;

  /// The journal of this query, engine and device to keep the answer in. An earlier one is
  /// removed where options.force or nothing is in it. Throws UsageError, naming what differs, where
  /// it is of others.
  SearchJournal& open(const StoreReader& store, const Query& query, const ResultHeader& header,
                      const std::string& engine, const std::string& device);

  /// The output's lock ended with its publication, and another process may have begun: its journal
  /// is left alone.
  void remove_after_publication();

  /// Of the earlier run.
  const JournalledWork& earlier() const { return earlier_; }

 private:
  bool is_of(const StoreReader& store, const ResultHeader& header) const;

  PendingFile& output_;
  const RunOptions& options_;
  std::filesystem::path path_;
  std::optional<JournalReader> read_;
  JournalledWork earlier_;
  std::string unwanted_;  ///< why the journal that is there is removed; empty where it is not
  bool replaces_;         ///< an existing output is to be overwritten
  std::optional<SearchJournal> results_;
};

}  // namespace clearway::tool
