// The built program against brute force, from standard input, damaged and in bounded memory.
#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "core/query/search_result.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/engines/brute_force.hpp"
#include "support/result_fixture.hpp"
#include "tools/cli/support/hall.hpp"
#include "tools/cli/support/spawned.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("the result is that of brute force") {
  const Work work;
  require_success(work.run_hall("hall/site.h5", "out.h5", "--first-pose"));
  const StoreReader store(work.hall.path("site.h5"));
  std::vector<Vec3> environment;
  for (const Quantum& q : points_by_source(store)) {
    environment.push_back(position(store.quantisation(), q[0], q[1], q[2]));
  }
  const auto model = read_model_points(work.hall.path("model.ply"));
  const auto poses = read_trajectory(work.hall.path("trajectory.txt"), {});
  const auto first = brute_force_first_poses(environment, {model, poses, {0.1, true}});
  Collisions expected;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i] == kNoPose) continue;
    expected.source.push_back(i);
    expected.xyz.push_back(environment[i]);
    expected.first_pose.push_back(first[i]);
  }
  CHECK(expected.size() > 100);
  CHECK(same_rows(read_rows(ResultReader(work.folder / "out.h5")), expected));
}

TEST_CASE("standard input makes the store of the file but for the description of its source") {
  const Work work;
  LasBytes las;
  las.minor = 4;
  las.format = 6;
  las.global_encoding = 16;
  las.points = cube_cloud(5000, -3000, 3000, 1);
  las.evlrs = {{"LASF_Projection", 2112, R"(LOCAL_CS["m",UNIT["metre",1]])"}};
  work.put("a.las", las.build());
  for (const std::string options : {"", " --scale 0.01", " --layout regular:5"}) {
    CAPTURE(options);
    const std::string end = std::string(" --cell-points 100 --force") + options + " -o ";
    work.succeed("convert a.las" + end + "file.h5");
    require_success(work.run("convert -" + end + "pipe.h5", work.folder / "a.las"));
    const StoreReader file(work.folder / "file.h5"), pipe(work.folder / "pipe.h5");
    CHECK(pipe.fingerprint() == file.fingerprint());
    CHECK(std::equal(pipe.top_tree().begin(), pipe.top_tree().end(), file.top_tree().begin(),
                     file.top_tree().end()));
    CHECK(pipe.metadata().unit == file.metadata().unit);
    CHECK(pipe.metadata().crs_wkt == file.metadata().crs_wkt);
    check_says(pipe.metadata().crs_wkt, "LOCAL_CS");
    CHECK(stored_points(pipe) == stored_points(file));
    CHECK(pipe.metadata().sources == std::vector<SourceFile>{{"-", 0, 0}});
  }
}

TEST_CASE("verify names what is damaged and exits with 1") {
  const Work work;
  std::string bytes = work.bytes("hall/site.h5");
  const std::uint64_t at = StoreReader(work.hall.path("site.h5")).index().address[2] + 100;
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  work.put("site.h5", bytes);
  check_outcome(work.run("verify site.h5"), 1, kAnything, "cell 0 ... 'z' ... damaged");
  check_refused(work.run_hall("site.h5", "out.h5"), 3, "cell 0");
  CHECK_FALSE(work.has("out.h5"));
  CHECK_FALSE(work.has("out.h5.partial"));
}

#ifndef CLEARWAY_SANITIZED  // sanitizers take memory of their own
TEST_CASE("a conversion stays within --memory") {
  const Work work;
  write_las(work.folder / "a.las", cube_cloud(4'500'000, -1000000, 1000000, 1));
  const std::uint64_t peak =
      peak_memory_of({"convert", (work.folder / "a.las").string(), "-o",
                      (work.folder / "a.h5").string(), "--memory", "224M", "--threads", "2"});
  CHECK(peak < (std::uint64_t{224} << 20));
}
#endif
