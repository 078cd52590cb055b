// Bodies and questions searched by the kernels' bodies on the host, as two GPUs would, against the
// CPU's sweep.
#include "search/kinds/visit_kind.hpp"

#include <atomic>

#include "search/kinds/cpu_kind.hpp"
#include "search/kinds/sweep_kind.hpp"
#include "search/visit.hpp"
#include "support/catch.hpp"
#include "support/engines/answer_sets.hpp"
#include "support/engines/host_sweep.hpp"
#include "support/questions.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr std::uint32_t kDevices = 2;

PageEngineNeeds needs_of_devices() {
  return {.most_slots = 3,
          .page_cells = 4,
          .page_bytes = std::uint64_t{1} << 16,
          .threads = 4,
          .waiting_threads = kDevices,
          .devices = kDevices,
          .on_gpu = true};
}

/// A kind of search like the one for CUDA, with engines that run the kernels' bodies on the host.
template <typename Element>
class HostKindOf final : public SweepKindOf<Element> {
 public:
  HostKindOf(const StoreReader& store, const Query& query, const SearchOptions& options)
      : SweepKindOf<Element>(needs_of_devices(), store, query, options, 3, {}) {
    this->needs_.most_device_bytes = std::uint64_t{1} << 40;
  }
  std::uint64_t host_bytes(const SlotLayout&, std::uint64_t) const override { return 0; }
  PageEngines make(const SlotLayout& layout) override {
    PageEngines engines;
    for (std::uint32_t device = 0; device < kDevices; ++device) {
      engines.push_back(
          std::make_unique<HostSweepOf<Element>>(this->cloud_, this->filter_->ref(), layout, 2000));
    }
    return engines;
  }
  void report_search(EngineList, SearchReport&, const MessageLog&) const override {}
};

using Questions = std::vector<VisitQuestion>;

std::unique_ptr<PageEngineKind> host_kind(const StoreReader& store, const Questions& questions,
                                          const SearchOptions& options) {
  return visit_kind(store, questions, [&](const Query& one) -> std::unique_ptr<PageEngineKind> {
    if (one.model.is_surface()) {
      return std::make_unique<HostKindOf<Triangle>>(store, one, options);
    }
    return std::make_unique<HostKindOf<Vec3>>(store, one, options);
  });
}

std::unique_ptr<PageEngineKind> kind_on_cpu(const StoreReader& store, const Questions& questions,
                                            const SearchOptions& options) {
  return visit_kind(store, questions,
                    [&](const Query& one) { return cpu_kind(store, one, options); });
}

/// The answers of a visit to its questions, which reads the coordinates of each cell once.
std::vector<SearchResult> answers_of(const StoreReader& store, const Questions& questions,
                                     PageEngineKind& kind) {
  NoProgress progress;
  std::vector<SearchResult> answers;
  for (const VisitQuestion& one : questions) answers.push_back(empty_result(store, one.query));
  using Search = IgnoredPoints::Search;
  const bool alone = questions.size() == 1;
  const bool of_ignored = questions.front().of == VisitQuestion::Of::kIgnored;
  const std::uint64_t before = store.bytes_read().coordinates;
  std::atomic<std::uint64_t> of_cells = 0;
  run_visit(store,
            {.query = questions.front().query,
             .memory_bytes = std::uint64_t{4} << 30,
             .kind = kind,
             .collect =
                 [&](std::span<const PlannedCell> cells, const PageResult& page) {
                   for (const PlannedCell& cell : cells) of_cells += store.packed_bytes(cell.cell);
                   add_page(store, cells, page, answers[0]);
                   for (std::size_t i = 1; i < answers.size(); ++i) {
                     add_page(store, cells, page.further[i - 1], answers[i]);
                   }
                 },
             .search = !alone       ? Search::kBoth
                       : of_ignored ? Search::kIgnored
                                    : Search::kOthers},
            progress);
  CHECK(store.bytes_read().coordinates - before == of_cells);
  return answers;
}

SearchResult answer_of(const StoreReader& store, const Query& query, PageEngineKind& kind) {
  return std::move(answers_of(store, {{query}}, kind).front());
}

}  // namespace

TEST_CASE("bodies on devices find what they find on the CPU") {
  const AskedScan scan(91, true);
  Query query = scan.vehicle(91);
  SECTION("sets") {}
  SECTION("first poses") { query.first_pose = true; }
  SECTION("clearances and a profile") {
    query.first_pose = true;
    query.clearance = 0.1;
    query.profile = 0.2;
  }
  SECTION("a body that is a surface") {
    query.bodies[1].model = scan.models[3];
    query.clearance = 0.1;
    query.profile = 0.2;
  }
  SECTION("a body that is nowhere") {
    query.bodies[1].poses.clear();
    query.bodies[1].path_pose.clear();
    query.profile = 0.2;
  }
  const StoreReader store(scan.store);
  const SearchOptions options{.threads = 2};
  const SearchResult expected = answer_of(store, query, *kind_on_cpu(store, {{query}}, options));
  const SearchResult found = answer_of(store, query, *host_kind(store, {{query}}, options));
  for (std::uint64_t entry = 0; entry < store.entry_count(); ++entry) {
    REQUIRE(found.hits.contains(entry) == expected.hits.contains(entry));
    if (query.first_pose) REQUIRE(found.hits.first_pose(entry) == expected.hits.first_pose(entry));
    if (query.clearance > 0) REQUIRE(found.clearances.at(entry) == expected.clearances.at(entry));
  }
  for (std::uint64_t pose = 0; pose < expected.profile.poses(); ++pose) {
    REQUIRE(found.profile.at(pose) == expected.profile.at(pose));
  }
  CHECK(found.hits.count() > 20);
}

TEST_CASE("a visit of several questions has the answers of visits of one") {
  const AskedScan scan(17, true);
  const bool has_bodies = GENERATE(false, true);
  CAPTURE(has_bodies);
  const Query vehicle = scan.vehicle(39, 600);
  Query query = vehicle;
  if (!has_bodies) query = Query(vehicle.bodies[0].model, vehicle.poses, {.radius = 0.06});
  query.first_pose = true;
  query.ignore_boxes = {{{100, -200, 0}, {102, -197, 1}}};
  Query wider = query, closer = query;
  wider.radius *= 2;
  closer.radius /= 2;
  closer.first_pose = false;
  const Query back = backwards(query);
  using Of = VisitQuestion::Of;
  const Questions questions{
      {query}, {query, Of::kIgnored}, {wider}, {back, Of::kHits}, {closer, Of::kHits}};
  const StoreReader store(scan.store);
  const SearchOptions options{.threads = 3};
  std::vector<SearchResult> alone;
  for (const VisitQuestion& one : questions) {
    alone.push_back(
        std::move(answers_of(store, {one}, *kind_on_cpu(store, {one}, options)).front()));
  }
  for (const bool on_host : {false, true}) {
    CAPTURE(on_host);
    const auto kind =
        on_host ? host_kind(store, questions, options) : kind_on_cpu(store, questions, options);
    const std::vector<SearchResult> found = answers_of(store, questions, *kind);
    for (std::size_t i = 0; i < questions.size(); ++i) {
      CAPTURE(i);
      CHECK(found[i].hits.count() > 5);
      for (std::uint64_t entry = 0; entry < store.entry_count(); ++entry) {
        REQUIRE(found[i].hits.contains(entry) == alone[i].hits.contains(entry));
        if (questions[i].query.first_pose) {
          REQUIRE(found[i].hits.first_pose(entry) == alone[i].hits.first_pose(entry));
        }
      }
    }
  }
}
