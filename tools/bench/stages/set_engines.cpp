#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>

#include "bench/stages/measures.hpp"
#include "clearway/error.hpp"
#include "core/describe/answer.hpp"
#include "core/util/stopwatch.hpp"
#include "io/files/facts_json.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/thread_limit.hpp"
#include "io/paths/content_hash.hpp"
#include "search/kinds/cpu_kind.hpp"
#include "search/kinds/grid_kind.hpp"
#include "search/result_header.hpp"
#include "search/visit.hpp"
#include "stream/search_journal.hpp"
#include "stream/write_result.hpp"
#ifdef CLEARWAY_CUDA
#include "search/kinds/cuda_kind.hpp"
#endif

namespace clearway::bench {
namespace {

void check(const SetEngines& asked) {
  const EngineSettings& settings = asked.settings;
  const bool grid = settings.grid.grid_cell > 0 || settings.grid.precision == GridPrecision::kFloat;
  if (settings.field_voxel > 0 && asked.search.engine != Engine::kSweep) {
    throw UsageError("a field voxel is of engine sweep");
  }
  if (grid && asked.search.engine != Engine::kGrid) {
    throw UsageError("a grid cell and float precision are of engine grid");
  }
}

std::unique_ptr<PageEngineKind> kind_of(const StoreReader& store, const Query& query,
                                        const SetEngines& asked, const SearchOptions& options,
                                        [[maybe_unused]] const MessageLog& log) {
#ifdef CLEARWAY_CUDA
  if (options.device == Device::kCuda) {
    const OpenGpus open = [&options, &log] {
      options.started->wait();
      return choose_device(options, log);
    };
    return cuda_kind(store, query, options, open, nullptr, asked.settings);
  }
#endif
  return cpu_kind(store, query, options, asked.settings);
}

}  // namespace

Json search_with_set_engines(const SetEngines& asked) {
  check(asked);
  const Stopwatch total;
  const Store opened(asked.environment);
  const StoreReader& store = opened.reader();
  SearchOptions options = asked.search;
  options.threads = threads_or_all(asked.threads);
  if (options.engine == Engine::kGrid) ::setenv("CUDA_DEVICE_MAX_CONNECTIONS", "32", 0);
  options.started = start_devices(options, &opened);
  PendingFile output(asked.output, true);
  const Query query = read_query(asked);
  const double inputs = total.seconds();

  SearchReport report;
  const MessageCallback silent;
  const MessageLog log(silent, report.warnings);
  NoProgress progress;
  const auto kind = kind_of(store, query, asked, options, log);
  RowsInMemory kept;
  AnswerRows rows(store, query, kept);
  FoundAnswer found{.rows = &rows};
  VisitEnd end = run_visit(store,
                           {.query = query,
                            .memory_bytes = options.memory_bytes,
                            .kind = *kind,
                            .collect = keep_answer(store, rows, found.profile, nullptr),
                            .least_write_bytes = least_write_bytes(store, query)},
                           progress, report, log);
  const std::uint64_t model_hash = hash_of_model(query.model);
  const ResultHeader header =
      result_header(store, query, std::span(&model_hash, 1),
                    [](const QueryParameters&) { return IgnoredPointCounts{}; });
  const Stopwatch writing;
  const TableSummary written = write_result(store, found, header, output.partial(), end.write_bytes,
                                            progress, {}, options.threads);
  output.publish();
  report.seconds.write = writing.seconds();
  end.engine_end.clear();

  Json out{{"radius", query.radius},
           {"environment_points", store.point_count()},
           {"model_points", query.model.vertices.size()},
           {"poses", query.poses.size()},
           {"colliding_points", written.colliding_points},
           {"engine", name_of(options.engine)},
           {"device", name_of(options.device)}};
  if (const auto* grid = dynamic_cast<const GridKind*>(kind.get())) {
    out["grid_cell"] = grid->grid_cell();
  }
  out.update({{"cells_total", store.cells().size()},
              {"cells_read", store.cells_touched()},
              {"bytes_read", store.bytes_read().coordinates},
              {"pages", report.pages},
              {"slots", report.slots},
              {"needed_host_bytes", report.needed_host_bytes},
              {"peak_device_bytes", report.peak_device_bytes}});
  out["seconds"] = json_of_fact(report.seconds);
  out["seconds"]["inputs"] = inputs;
  out["seconds"]["total"] = total.seconds();
  return out;
}

}  // namespace clearway::bench
