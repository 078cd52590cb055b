// The built program on LAZ, and on LAS whose writer crashed: as files and from standard input.
#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "tools/cli/support/hall.hpp"
#include "tools/cli/support/spawned.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("LAZ from a file and from standard input makes the store of its LAS twin") {
  const Work work;
  LazBytes laz = laz_bytes(7, 5000);
  laz.chunks = {300};
  laz.las.points = positions_of(laz.points);
  work.put("a.laz", laz.build());
  work.put("a.las", laz.las.build());
  const std::string end = " --cell-points 100 -o ";
  work.succeed("convert a.las" + end + "las.h5");
  work.succeed("convert a.laz" + end + "laz.h5");
  require_success(work.run("convert -" + end + "pipe.h5", work.folder / "a.laz"));
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
  work.put("a.las", bytes);
  const std::string end = " -o a.h5";
  check_outcome(work.run("convert a.las" + end), 3,
                "declares 0 points ... holds 5000 records ... convert - <");
  CHECK_FALSE(work.has("a.h5"));
  check_outcome(work.run("convert -" + end, work.folder / "a.las"), 0,
                "declares 0 points ... 5000 came");
  CHECK(stored_points(StoreReader(work.folder / "a.h5")).size() == 5000);
}
