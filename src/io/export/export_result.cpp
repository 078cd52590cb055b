#include "io/export/export_result.hpp"

#include "clearway/error.hpp"
#include "io/export/row_sink.hpp"
#include "io/result/result.hpp"
#include "io/system/pending_file.hpp"

namespace clearway {
namespace {

template <typename Rows>
void export_table(const ResultReader& result, const std::filesystem::path& output, bool overwrite,
                  Progress& progress) {
  const ExportFormat format = export_format_of(output);
  refuse_overwriting(output, {result.name()});
  PendingFile pending(output, overwrite);
  {
    const File file = File::create(pending.partial());
    QuantumBox bounds{};
    if (format == ExportFormat::kLas) bounds = bounds_of<Rows>(result, progress);
    const auto sink = make_row_sink<Rows>(format, result, bounds, file);
    progress.begin("export", result.rows<Rows>(), "points");
    RowStream<Rows> stream(result);
    for (Rows rows; stream.read(rows);) {
      throw_if_stopped(progress);
      sink->write(rows);
      progress.advance(rows.size());
    }
    sink->finish();
    progress.end();
  }
  pending.publish();
}

}  // namespace

void export_result(const ResultReader& result, const std::filesystem::path& output, bool overwrite,
                   Progress& progress) {
  export_table<Collisions>(result, output, overwrite, progress);
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
  export_table<Clearances>(result, output, overwrite, progress);
}

}  // namespace clearway
