// The built program on LAZ, and on LAS whose writer crashed: as files and from standard input.
#include <catch2/catch.hpp>

#include "support/bytes/laz/laz_samples.hpp"
#include "support/clouds.hpp"
#include "tools/cli/support/hall.hpp"
#include "tools/cli/support/spawned.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

TEST_CASE("LAZ from a file and from standard input makes the store of its LAS twin") {
  const Work work;
  LazBytes laz = laz_bytes(7, 5000);
  laz.chunks = {300};
  laz.las.points = positions_of(laz.points);
  put_bytes(work.folder / "a.laz", laz.build());
  put_bytes(work.folder / "a.las", laz.las.build());
  const std::string end = " --cell-points 100 -o ";
  REQUIRE(work.run("convert " + work.path("a.las") + end + work.path("las.h5")).exit_code == 0);
  REQUIRE(work.run("convert " + work.path("a.laz") + end + work.path("laz.h5")).exit_code == 0);
  REQUIRE(work.run("convert -" + end + work.path("pipe.h5"), work.folder / "a.laz").exit_code == 0);
  const StoreReader las(work.folder / "las.h5");
  for (const char* name : {"laz.h5", "pipe.h5"}) {
    const StoreReader store(work.folder / name);
    CHECK(stored_points(store) == stored_points(las));
    CHECK(store.quantisation() == las.quantisation());
  }
}

TEST_CASE("a LAS file without its count is refused, and read from standard input with a warning") {
  const Work work;
  LasBytes las;
  las.points = cube_cloud(5000, -3000, 3000, 1);
  std::string bytes = las.build();
  LasBytes::put<std::uint32_t>(bytes, 107, 0);
  put_bytes(work.folder / "a.las", bytes);
  const std::string end = " -o " + work.path("a.h5");
  const Outcome file = work.run("convert " + work.path("a.las") + end);
  CHECK(file.exit_code == 3);
  CHECK_THAT(file.err, Contains("declares 0 points") && Contains("holds 5000 records") &&
                           Contains("convert - <"));
  CHECK_FALSE(std::filesystem::exists(work.folder / "a.h5"));
  const Outcome pipe = work.run("convert -" + end, work.folder / "a.las");
  CHECK(pipe.exit_code == 0);
  CHECK_THAT(pipe.err, Contains("declares 0 points") && Contains("5000 came"));
  CHECK(stored_points(StoreReader(work.folder / "a.h5")).size() == 5000);
}
