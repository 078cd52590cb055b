// What share of a scene a search touches, and what touching more than that would cost.
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "bench/stages/measures.hpp"
#include "core/util/stopwatch.hpp"
#include "cpu/sweep_engine.hpp"
#include "io/files/thread_limit.hpp"
#include "io/paths/content_hash.hpp"
#include "io/store/store_reader.hpp"
#include "search/kept_models.hpp"
#include "search/kinds/sweep_kind.hpp"
#include "search/visit.hpp"
#include "stream/search_journal.hpp"

namespace clearway::bench {
namespace {

/// What a search is made to do although it need not.
struct Forced {
  bool all_cells = false;    ///< reads and searches every cell
  bool whole_field = false;  ///< makes every brick of the model field
};

/// The sweep on the CPU, which tells what it touched.
class CountingKind final : public CpuSweepKindOf<Vec3> {
 public:
  CountingKind(const PackedCloud& cloud, const Query& query, const SearchOptions& options,
               Forced forced)
      : CpuSweepKindOf<Vec3>(cloud, query, options, {}), forced_(forced) {}

  const PoseReach& build_index(const QueryTrees& trees, std::uint64_t most_bytes) override {
    needs_.on_gpu = forced_.whole_field;  // a field for a GPU is made whole
    const PoseReach& reach = CpuSweepKindOf<Vec3>::build_index(trees, most_bytes);
    needs_.on_gpu = false;
    return reach;
  }

  std::vector<PlannedCell> plan_cells(const PackedCloud& cloud,
                                      const PoseReach& reach) const override {
    if (!forced_.all_cells) return CpuSweepKindOf<Vec3>::plan_cells(cloud, reach);
    std::vector<PlannedCell> cells(cloud.cells().size());
    for (std::uint32_t i = 0; i < cells.size(); ++i) cells[i] = {i, {0}};
    return cells;
  }

  void report_search(EngineList engines, SearchReport&, const MessageLog&) const override {
    tests_ = dynamic_cast<const SweepEngine&>(*engines.front()).statistics();
  }

  const SweepStatistics& tests() const { return tests_; }
  const ModelField& field() const { return *field_; }

 private:
  Forced forced_;
  mutable SweepStatistics tests_;
};

class Share {
 public:
  explicit Share(const ShareOptions& asked)
      : asked_(asked), query_(read_query(asked)), model_hash_(hash_of_model(query_.model)) {
    options_.threads = threads_or_all(asked.threads);
    options_.device = Device::kCpu;
    options_.engine = Engine::kSweep;
  }

  Json measured() {
    return {{"as it is", repeated({})},
            {"all cells", repeated({.all_cells = true})},
            {"whole field", repeated({.whole_field = true})},
            {"poses one by one", one_by_one()}};
  }

 private:
  static constexpr std::size_t kSinglePoses = 64;

  /// The search that takes the median time.
  Json repeated(Forced forced) {
    std::vector<Json> found;
    for (int i = 0; i < asked_.repetitions; ++i) found.push_back(search(query_, forced));
    std::ranges::sort(found, {}, [](const Json& one) { return one["seconds"].get<double>(); });
    return found[found.size() / 2];
  }

  /// Each pose as a question of its own, as a session asks it, which keeps what it knows of the
  /// model: the mean of some poses along the way, for all.
  Json one_by_one() {
    KeptModels kept(KeptModels::Kept::kForSession, std::numeric_limits<std::uint64_t>::max());
    const std::size_t step = std::max<std::size_t>(1, query_.poses.size() / kSinglePoses);
    std::vector<double> seconds;
    for (std::size_t i = 0; i < query_.poses.size(); i += step) {
      const Query one(query_.model, {query_.poses[i]}, {.radius = asked_.radius});
      const double taken = search(one, {}, &kept)["seconds"];
      if (i > 0) seconds.push_back(taken);  // the first one makes the field
    }
    if (seconds.empty()) return Json::object();
    const double mean =
        std::reduce(seconds.begin(), seconds.end()) / static_cast<double>(seconds.size());
    return {{"seconds", mean * static_cast<double>(query_.poses.size())},
            {"searched_poses", seconds.size()}};
  }

  /// One search, of a store that nothing has been read from yet.
  Json search(const Query& query, Forced forced, KeptModels* kept = nullptr) {
    const StoreReader store(asked_.environment);
    SearchReport report;
    const MessageCallback silent;
    const MessageLog log(silent, report.warnings);
    NoProgress progress;
    CountingKind kind(store, query, options_, forced);
    if (kept != nullptr) kind.keep_models_in(*kept, {model_hash_});
    const Stopwatch clock;
    RowsInMemory kept_rows;
    AnswerRows rows(store, query, kept_rows);
    ProfileSet no_profile;
    run_visit(store,
              {.query = query,
               .memory_bytes = options_.memory_bytes,
               .kind = kind,
               .collect = keep_answer(store, rows, no_profile, nullptr)},
              progress, report, log);
    const double seconds = clock.seconds();
    const SweepStatistics& tests = kind.tests();
    return {{"seconds", seconds},
            {"field_seconds", report.seconds.field},
            {"search_seconds", report.seconds.search},
            {"colliding_points", rows.points(PointQuestion::kHits)},
            {"points", store.point_count()},
            {"points_tested", tests.points_tested},
            {"poses", query.poses.size()},
            {"model_points", query.model.vertices.size()},
            {"cells", store.cells().size()},
            {"cells_read", store.cells_touched()},
            {"blocks", store.cells().size() * store.blocks_per_cell()},
            {"bytes", std::filesystem::file_size(asked_.environment)},
            {"bytes_read", store.bytes_read().coordinates},
            {"box_tests", tests.node_tests},
            {"point_tests", tests.point_tests},
            {"exact_tests", tests.exact_tests},
            {"bricks", kind.field().bricks()},
            {"bricks_made", kind.field().made_bricks()}};
  }

  ShareOptions asked_;
  Query query_;
  std::uint64_t model_hash_;
  SearchOptions options_;
};

}  // namespace

Json measure_shares(const ShareOptions& options) { return Share(options).measured(); }

}  // namespace clearway::bench
