// LAZ is read within a conversion's pipeline, whose threads it shares.
#include <catch2/catch.hpp>

#include "support/bytes/laz/laz_samples.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("the store of a LAZ file holds the points of the file in their order") {
  const unsigned format = GENERATE(3u, 6u);
  LazBytes laz = laz_bytes(format, 150000);
  laz.chunks = {7001};
  const ScratchFolder folder;
  put_bytes(folder / "a.laz", laz.build());
  for (const int threads : {1, 2, 4}) {
    ConversionOptions options = conversion_of({folder / "a.laz"}, folder / "a.h5", 1000);
    options.threads = threads;
    CHECK(convert_quietly(options).warnings.empty());
    std::vector<StoredPoint> points = stored_points(StoreReader(folder / "a.h5"));
    std::sort(points.begin(), points.end(),
              [](const StoredPoint& a, const StoredPoint& b) { return a.source < b.source; });
    REQUIRE(points.size() == laz.points.size());
    bool same = true;
    for (std::size_t i = 0; i < points.size(); ++i) {
      same = same && points[i] == StoredPoint{i, laz.points[i].position};
    }
    CHECK(same);
  }
}

TEST_CASE("a damaged chunk ends a conversion with the chunk's number, by any number of threads") {
  LazBytes laz = laz_bytes(6, 60000);
  laz.chunks = {7001};
  std::string bytes = laz.build();
  for (std::size_t at = bytes.size() / 2; at < bytes.size() - 200; ++at) bytes[at] = 'x';
  const ScratchFolder folder;
  put_bytes(folder / "a.laz", bytes);
  std::string first;
  for (const int threads : {1, 2, 4}) {
    ConversionOptions options = conversion_of({folder / "a.laz"}, folder / "a.h5");
    options.threads = threads;
    const std::string message = conversion_refusal<InputError>(options);
    CHECK_THAT(message, Catch::Matchers::Contains("a.laz: chunk "));
    if (first.empty()) first = message;
    CHECK(message == first);
  }
}
