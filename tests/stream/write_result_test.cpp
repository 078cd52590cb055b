#include "stream/write_result.hpp"

#include <cmath>
#include <optional>

#include "io/result/check_results.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr std::uint64_t kPoints = 230'000;  // a pass takes 65,536 rows at least

/// A store whose order differs widely from that of the sources.
class Site {
 public:
  Site() {
    write_las(folder_ / "a.las", cube_cloud(kPoints, -100'000, 100'000, 1));
    convert_quietly(conversion_of({folder_ / "a.las"}, folder_ / "a.h5", 1000));
    store_.emplace(folder_ / "a.h5");
  }

  const StoreReader& store() const { return *store_; }

  /// Writes the answer and returns the bytes of the result file.
  std::string written(const FoundAnswer& answer, const ResultHeader& header,
                      std::uint64_t memory_bytes, int threads = 0) const {
    NoProgress progress;
    found_ = write_result(*store_, answer, header, folder_ / "out.h5", memory_bytes, progress, {},
                          threads);
    CHECK_FALSE(verify_result(ResultReader(folder_ / "out.h5"), progress));
    return bytes_of(folder_ / "out.h5");
  }

  /// What the last call of written() reported.
  const TableSummary& found() const { return found_; }

  ResultReader result() const { return ResultReader(folder_ / "out.h5"); }

 private:
  ScratchFolder folder_;
  std::optional<StoreReader> store_;
  mutable TableSummary found_;
};

ResultHeader header_of(const StoreReader& store) {
  ResultHeader header = sample_header(true);
  header.environment_points = store.point_count();
  header.quantisation = store.quantisation();
  header.clearance = 0.75;
  return header;
}

constexpr std::uint32_t kPoses = 100'003;

std::uint32_t pose_of(std::uint64_t source) {
  return static_cast<std::uint32_t>(source * 7 % kPoses);
}

double squared_of(std::uint64_t source) { return 1 / (4 + static_cast<double>(source)); }

/// An answer in which most points have a clearance and a hit, both computed from the source index.
class MadeAnswer {
 public:
  explicit MadeAnswer(const StoreReader& store) : rows_(store, query_, kept_) {
    for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
      const auto sources = store.sources(cell);
      CellRows hits{.words = std::vector<std::uint64_t>(store.blocks_per_cell())};
      CellRows clearances = hits;
      for (std::uint32_t i = 0; i < store.cells()[cell].count; ++i) {
        const std::uint64_t source = sources[i], bit = std::uint64_t{1} << i % 64;
        if (source % 11 != 3) {
          hits.words[i / 64] |= bit;
          hits.poses.push_back(pose_of(source));
        }
        if (source % 5 != 2) {
          clearances.words[i / 64] |= bit;
          clearances.poses.push_back(pose_of(source));
          clearances.distances.push_back(squared_of(source));
        }
      }
      rows_.add(cell, {{PointQuestion::kHits, hits}, {PointQuestion::kClearances, clearances}});
    }
    found.rows = &rows_;
  }

  FoundAnswer found;

 private:
  const Query query_{{{0, 0, 0}},
                     std::vector<Pose>(kPoses),
                     {.radius = 0.1, .first_pose = true, .clearance = 0.75}};
  RowsInMemory kept_;
  AnswerRows rows_;
};

/// The position of the point with each source index.
std::vector<Vec3> places_of(const StoreReader& store) {
  std::vector<Vec3> places(store.point_count());
  for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
    const auto sources = store.sources(cell);
    const auto q = store.coordinates(cell);
    for (std::uint32_t i = 0; i < store.cells()[cell].count; ++i) {
      places[sources[i]] = position(store.quantisation(), q[0][i], q[1][i], q[2][i]);
    }
  }
  return places;
}

}  // namespace

TEST_CASE("a result has the same bytes, however many passes and threads write it") {
  const Site site;
  const MadeAnswer made(site.store());
  const ResultHeader header = header_of(site.store());
  constexpr std::uint64_t kMuch = std::uint64_t{1} << 30;
  const std::string once = site.written(made.found, header, kMuch, 1);
  for (const auto& [memory, threads] : std::vector<std::pair<std::uint64_t, int>>{
           {kMuch, 2}, {kMuch, 16}, {0, 1}, {0, 3}, {1, 0}, {5'000'000, 2}, {12'000'000, 0}}) {
    CAPTURE(memory, threads);
    CHECK((site.written(made.found, header, memory, threads) == once));
  }

  const std::vector<Vec3> places = places_of(site.store());
  const ResultReader result = site.result();
  Clearances all, batch;
  std::optional<FoundPlace> least;
  std::uint64_t wrong = 0, source = 0;
  for (RowStream<Clearances> stream(result); stream.read(batch);) {
    for (std::size_t i = 0; i < batch.size(); ++i, ++source) {
      if (source % 5 == 2) ++source;
      wrong += batch.source[i] != source || batch.pose[i] != pose_of(source) ||
               batch.distance[i] != std::sqrt(squared_of(source)) || batch.xyz[i] != places[source];
      if (!least || batch.distance[i] < least->distance) {
        least = {batch.source[i], batch.pose[i], batch.xyz[i], batch.distance[i]};
      }
      all.source.push_back(batch.source[i]);
      all.xyz.push_back(batch.xyz[i]);
      all.distance.push_back(batch.distance[i]);
      all.pose.push_back(batch.pose[i]);
    }
  }
  check_equal(wrong, 0);
  CHECK(source == kPoints);

  const Collisions rows = read_rows(result);
  const auto first =
      static_cast<std::size_t>(std::ranges::min_element(rows.first_pose) - rows.first_pose.begin());
  const FoundPlace first_place{rows.source[first], rows.first_pose[first], rows.xyz[first], 0};
  CHECK(site.found().colliding_points == result.collisions());
  CHECK(site.found().clearance_points == result.clearances());
  CHECK(site.found().first_place == first_place);
  CHECK(site.found().least_clearance == least);
  CHECK_FALSE(site.found().least_profile);

  const ScratchFolder folder;  // rows that are appended give the same bytes, too
  write_result(folder / "again.h5", header, rows, 7001, all);
  CHECK((bytes_of(folder / "again.h5") == once));
}
