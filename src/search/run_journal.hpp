#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "clearway/search.hpp"
#include "core/util/message_log.hpp"
#include "core/util/progress.hpp"
#include "io/journal/journal.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"
#include "io/system/pending_file.hpp"
#include "stream/journalled_work.hpp"
#include "stream/search_journal.hpp"

namespace clearway {

/// The journal beside the output of a search: what an earlier run left there, and what this
/// one keeps.
class RunJournal {
 public:
  /// Looks for an earlier journal. Throws UsageError, saying what was found and what to do, where
  /// there is one and neither options.resume nor options.overwrite.
  /// The output is this process's alone. All outlive it; pending is of the path `output`.
  RunJournal(PendingFile& pending, const std::filesystem::path& output,
             const SearchOptions& options, MessageLog& log);

  /// Whether, with options.resume, the output is there, intact, and answers this query: exactly,
  /// or from an earlier run that was only kept from removing its journal. A journal is removed
  /// then. Throws as refuse_existing() where another output is there.
  bool already_done(const StoreReader& store, const ResultHeader& header, Progress& progress);

  /// Throws UsageError where there is an output that this run may not overwrite. It says whether
  /// the output answers this query or which inputs and parameters differ, because whoever reads
  /// the output next would take its answer for that of this run.
  void refuse_existing(const ResultHeader& header) const;

  /// As the run to resume was started with; kAuto where there is none.
  Device earlier_device() const;
  Engine earlier_engine() const;

  /// The journal of this query, engine and device to keep the answer in. An earlier one is
  /// removed where options.overwrite or nothing is in it. Throws UsageError, naming what differs,
  /// where it is of others.
  SearchJournal& open(const StoreReader& store, const Query& query, const ResultHeader& header,
                      Engine engine, Device device);

  /// The output's lock ended with its publication, and another process may have begun: its journal
  /// is left alone.
  void remove_after_publication();

  const std::filesystem::path& output() const { return output_; }

  /// Of the earlier run.
  const JournalledWork& earlier() const { return earlier_; }

 private:
  bool is_of(const StoreReader& store, const ResultHeader& header) const;
  void refuse_other_part(const ResultHeader& header) const;

  PendingFile& pending_;
  const std::filesystem::path& output_;
  const SearchOptions& options_;
  MessageLog& log_;
  std::filesystem::path path_;
  std::optional<JournalReader> read_;
  JournalledWork earlier_;
  std::string unwanted_;  ///< why the journal that is there is removed; empty where it is not
  bool replaces_;         ///< an existing output is to be overwritten
  std::optional<SearchJournal> results_;
};

}  // namespace clearway
