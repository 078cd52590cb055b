#include "clearway/merge.hpp"

#include <optional>
#include <utility>

#include "clearway/error.hpp"
#include "core/messages/messages.hpp"
#include "core/util/format.hpp"
#include "core/util/progress.hpp"
#include "findings/certain_points.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/thread_limit.hpp"
#include "io/result/answer.hpp"
#include "io/result/check_results.hpp"
#include "io/result/merge_parts.hpp"
#include "search/ignored.hpp"
#include "search/seen_space.hpp"

namespace clearway {
namespace {

/// Whether the output exists, is intact, and has the question of the parts.
bool has_same_question(const PartSet& set, const std::filesystem::path& output,
                       Progress& progress) {
  return std::filesystem::exists(output) && is_intact_result(output, set.header(), progress);
}

/// Whether an output with the question of the parts says of the inputs what they say.
bool has_same_notes(const PartSet& set, const std::filesystem::path& output) {
  return ResultReader(output).header().notes == set.header().notes;
}

/// Whether an output with the question of the parts has as many rows as they.
bool has_same_rows(const PartSet& set, const std::filesystem::path& output) {
  const ResultReader result(output);
  return result.collisions() == set.collisions() && result.clearances() == set.clearances() &&
         result.near() == set.near();
}

MergeReport report_of(const PartSet& set) {
  MergeReport report;
  static_cast<Answer&>(report) = set.answer();
  report.length_unit = set.parts().front().header().notes.length_unit;
  report.parts = static_cast<std::uint32_t>(set.parts().size());
  report.part_warnings = set.warnings();
  return report;
}

/// Adds to the warnings of the parts what can be judged only for all parts together: groups of
/// unseen cubes that are too small to be listed, and ignored points that may have made the answer.
void warn_of_all(const PartSet& set, const MergeOptions& options, MergeReport& report) {
  const ResultHeader& first = set.parts().front().header();
  std::vector<Message> warnings;
  MessageLog log(options.message, warnings);
  if (report.seen) warn_of_small_groups(*report.seen, set.header(), log);
  warn_of_colliding_ignored(report, length_unit_of(first.notes.length_unit), log);
  add_warnings(warnings, report.warnings);
  for (Message& warning : warnings) {
    report.part_warnings.push_back({std::move(warning), report.parts});
  }
}

/// Replaces the warnings of the parts about beams and swept cubes by those of all parts together,
/// as one search of everything gives them.
void join_warnings_of_beams(const PartSet& set, std::vector<Message>& warnings) {
  BeamCounts left_out;
  for (const ResultReader& part : set.parts()) {
    for (const Message& warning : part.findings().warnings) {
      takes_warning_of_beams(warning, left_out);
    }
  }
  BeamCounts unused;
  std::erase_if(warnings, [&](const Message& m) { return takes_warning_of_beams(m, unused); });
  const MessageCallback silent;  // the warnings of the parts have been passed on
  MessageLog log(silent, warnings);
  warn_of_beams(left_out, log);
  warn_of_nothing_swept(*set.parts().front().findings().seen, set.header().poses, log);
}

template <typename Rows>
Rows rows_of(const ResultReader& part) {
  Rows rows;
  RowStream<Rows> stream(part);
  for (Rows some; stream.read(some);) append_rows(some, rows);
  return rows;
}

/// The cubes that the beams of no part saw, and the cells that all parts sweep alike.
MergedSpace space_of_all(const PartSet& set) {
  MergedSpace out;
  UnseenCubes& all = out.unseen;
  bool first = true;
  for (const ResultReader& part : set.parts()) {
    const SeenSummary &own = *part.findings().seen, &other = *set.parts().front().findings().seen;
    SweptCells swept = rows_of<SweptCells>(part);
    if (own.swept != other.swept || own.cube != other.cube || (!first && swept != out.swept)) {
      throw InputError(part.name() + ": sweeps other cubes than " + set.parts().front().name());
    }
    UnseenCubes rows = rows_of<UnseenCubes>(part);
    if (first) {
      all = std::move(rows);
      out.swept = std::move(swept);
      first = false;
      continue;
    }
    UnseenCubes both;
    for (std::size_t i = 0, j = 0; i < all.size() && j < rows.size();) {
      if (all.cube[i] == rows.cube[j]) append_row(part.header(), all, i, both);
      const bool further_in_all = all.cube[i] <= rows.cube[j];
      const bool further_in_rows = rows.cube[j] <= all.cube[i];
      i += further_in_all;
      j += further_in_rows;
    }
    all = std::move(both);
  }
  return out;
}

/// Passes on the warnings of the parts, also where the result existed already. Throws where
/// options.strict treats them as errors.
void tell_warnings(const std::vector<PartWarning>& warnings, std::uint32_t parts,
                   const MergeOptions& options) {
  for (const PartWarning& warning : warnings) {
    Message merged = warning;
    merged.text += warning.parts == parts ? " (in all parts)"
                                          : " (in " + std::to_string(warning.parts) + " of " +
                                                counted(parts, "part") + ")";
    if (options.message) options.message(merged);
  }
  if (options.strict) refuse_warnings({warnings.begin(), warnings.end()});
}

}  // namespace

MergeReport merge(const std::vector<std::filesystem::path>& parts,
                  const std::filesystem::path& output, const MergeOptions& options) {
  refuse_overwriting(output, parts);
  PendingFile pending(output, options.overwrite || options.resume);
  CallbackProgress progress(options.progress, options.stop);
  return in_threads(options.threads, [&] {
    const PartSet set(parts);
    MergeReport report = report_of(set);
    tell_warnings(report.part_warnings, report.parts, options);
    const bool is_there = options.resume && has_same_question(set, output, progress);
    const bool is_outdated = is_there && !has_same_notes(set, output);
    report.was_finished = is_there && !is_outdated && has_same_rows(set, output);
    if (report.was_finished) {
      static_cast<Answer&>(report) = answer_of(ResultReader(output));
      warn_of_all(set, options, report);
      return report;
    }
    if (!options.overwrite && !is_outdated) pending.refuse_existing();
    ResultFindings findings = set.findings();
    if (set.header().budget) {
      report.certain = certain_points_in(set.parts(), progress);
      findings.certain = report.certain;
    }
    std::optional<MergedSpace> space;
    if (set.header().seen) {
      check_merge_memory(set, options.memory_bytes);
      space = space_of_all(set);
      SeenSummary& seen = findings.seen.emplace(*set.parts().front().findings().seen);
      group_unseen(set.header(), space->unseen, seen);
      report.seen = seen;
      join_warnings_of_beams(set, report.warnings);
    }
    warn_of_all(set, options, report);
    findings.warnings = report.warnings;
    merge_parts(set, space, pending.partial(), options.memory_bytes, findings, progress, report);
    pending.publish();
    return report;
  });
}

}  // namespace clearway
