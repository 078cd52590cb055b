// Bodies searched by the kernels' bodies on the host, as two GPUs would, against the CPU's sweep.
#include "search/kinds/body_kind.hpp"

#include "search/body_queries.hpp"
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

std::unique_ptr<PageEngineKind> host_kind(const StoreReader& store, const Query& query,
                                          const SearchOptions& options) {
  std::vector<Query> queries = body_queries(query);
  BodyKind::Kinds kinds;
  for (const Query& body : queries) {
    if (body.model.is_surface()) {
      kinds.push_back(std::make_unique<HostKindOf<Triangle>>(store, body, options));
    } else {
      kinds.push_back(std::make_unique<HostKindOf<Vec3>>(store, body, options));
    }
  }
  return std::make_unique<BodyKind>(store, query, std::move(queries), std::move(kinds));
}

SearchResult answer_of(const StoreReader& store, const Query& query, PageEngineKind& kind) {
  NoProgress progress;
  SearchResult answer = empty_result(store, query);
  run_visit(store,
            {.query = query,
             .memory_bytes = std::uint64_t{1} << 30,
             .kind = kind,
             .collect = [&](std::span<const PlannedCell> cells,
                            const PageResult& page) { add_page(store, cells, page, answer); }},
            progress);
  return answer;
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
  const SearchResult expected = answer_of(store, query, *cpu_body_kind(store, query, options));
  const SearchResult found = answer_of(store, query, *host_kind(store, query, options));
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
