#include "io/export/export_result.hpp"

#include "clearway/error.hpp"
#include "io/export/row_sink.hpp"
#include "io/result/result_rows.hpp"
#include "io/system/pending_file.hpp"

namespace clearway {
namespace {

ExportRows export_rows(const ResultRows& rows) {
  return {.source = rows.source, .xyz = rows.xyz, .first_pose = rows.first_pose, .body = rows.body};
}

ExportRows export_rows(const ClearanceRows& rows) {
  return {.source = rows.source,
          .xyz = rows.xyz,
          .distance = rows.distance,
          .pose = rows.pose,
          .body = rows.body};
}

/// Calls visit(rows) for all rows of a table.
template <typename Stream, typename Rows, typename Visit>
void for_each_batch(const ResultReader& result, const Progress& progress, Visit visit) {
  Stream stream(result);
  for (Rows rows; stream.read(rows);) {
    throw_if_stopped(progress);
    visit(export_rows(rows));
  }
}

template <typename Stream, typename Rows>
void export_table(ExportTable table, const std::filesystem::path& output, bool overwrite,
                  Progress& progress) {
  const ExportFormat format = export_format_of(output);
  refuse_overwriting(output, {table.result.name()});
  PendingFile pending(output, overwrite);
  {
    const File file = File::create(pending.partial());
    if (format == ExportFormat::kLas) {
      bool any = false;
      for_each_batch<Stream, Rows>(table.result, progress, [&](const ExportRows& rows) {
        unite_rows(table, rows, any, table.bounds);
      });
    }
    const auto sink = make_row_sink(format, table, file);
    progress.begin("export", table.rows, "points");
    for_each_batch<Stream, Rows>(table.result, progress, [&](const ExportRows& rows) {
      sink->write(rows);
      progress.advance(rows.source.size());
    });
    sink->finish();
    progress.end();
  }
  pending.publish();
}

}  // namespace

void export_result(const ResultReader& result, const std::filesystem::path& output, bool overwrite,
                   Progress& progress) {
  export_table<ResultRowStream, ResultRows>({.result = result,
                                             .group = "collisions",
                                             .rows = result.collisions(),
                                             .first_pose = result.header().first_pose,
                                             .body = result.header().has_first_bodies()},
                                            output, overwrite, progress);
}

void export_clearances(const ResultReader& result, const std::filesystem::path& output,
                       bool overwrite, Progress& progress) {
  if (!(result.header().clearance > 0)) {
    throw UsageError(result.name() + ": has no clearances", Remedy::kAskForClearance);
  }
  if (!result.header().has_clearance_xyz() && export_format_of(output) != ExportFormat::kCsv) {
    throw InputError(result.name() +
                     ": is of version 2 and has no coordinates of clearances; run the query again, "
                     "or export a .csv without coordinates");
  }
  export_table<ClearanceRowStream, ClearanceRows>({.result = result,
                                                   .group = "clearance",
                                                   .rows = result.clearances(),
                                                   .distance = true,
                                                   .body = !result.header().bodies.empty()},
                                                  output, overwrite, progress);
}

}  // namespace clearway
