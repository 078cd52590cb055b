#include "clearway/merge.hpp"

#include "clearway/error.hpp"
#include "core/util/callback_progress.hpp"
#include "core/util/format.hpp"
#include "core/util/message_log.hpp"
#include "io/merge/merge_parts.hpp"
#include "io/result/check/verify_result.hpp"
#include "io/system/pending_file.hpp"
#include "search/threads.hpp"

namespace clearway {
namespace {

/// Whether the output is there, and intact: what it says follows from the question, but with a
/// tolerance or in floats.
bool is_merged(const PartSet& set, const std::filesystem::path& output, Progress& progress) {
  if (!std::filesystem::exists(output)) return false;
  if (set.header().tolerance > 0 || set.header().float_precision) return false;
  if (!is_intact_result(output, set.header(), progress)) return false;
  const ResultReader result(output);
  return result.collisions() == set.collisions() && result.clearances() == set.clearances();
}

MergeReport report_of(const PartSet& set) {
  MergeReport report;
  report.parameters = set.header();
  report.length_unit = set.parts().front().header().part->length_unit;
  report.parts = static_cast<std::uint32_t>(set.parts().size());
  report.environment_points = set.header().environment_points;
  report.model_points = set.header().model_points;
  report.model_solids = set.header().model_solids;
  report.poses = set.header().poses;
  report.bodies = set.header().bodies;
  report.colliding_points = set.collisions();
  report.clearance_points = set.clearances();
  report.warnings = set.warnings();
  report.ignored = set.header().ignored;
  return report;
}

/// Of a result that is there already too.
void tell_warnings(const std::vector<PartWarning>& warnings, std::uint32_t parts,
                   const MergeOptions& options) {
  for (const PartWarning& warning : warnings) {
    Message told = warning;
    told.text += warning.parts == parts ? " (in all parts)"
                                        : " (in " + std::to_string(warning.parts) + " of " +
                                              counted(parts, "part") + ")";
    if (options.message) options.message(told);
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
    tell_warnings(report.warnings, report.parts, options);
    report.was_finished = options.resume && is_merged(set, output, progress);
    if (report.was_finished) return report;
    if (!options.overwrite) pending.refuse_existing();
    const MergedResult merged = merge_parts(set, pending.partial(), options.memory_bytes, progress);
    pending.publish();
    report.profile_poses = merged.profile_poses;
    report.inside_points = merged.inside_points;
    report.first_place = merged.first_place;
    report.least_clearance = merged.least_clearance;
    report.least_profile = merged.least_profile;
    return report;
  });
}

}  // namespace clearway
