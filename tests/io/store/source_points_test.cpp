#include <hdf5.h>

#include <catch2/catch.hpp>

#include "clearway/error.hpp"
#include "io/files/hdf5.hpp"
#include "io/store/store_reader.hpp"
#include "support/clouds.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

using Counts = std::vector<std::uint64_t>;

/// Two scans, of 100 and of 250 points.
struct TwoScans {
  TwoScans() {
    write_las(folder / "a.las", cube_cloud(100, -4000, 4000, 3));
    write_las(folder / "b.las", cube_cloud(250, -4000, 4000, 4));
    convert_quietly(conversion_of({folder / "a.las", folder / "b.las"}, folder / "site.h5"));
  }
  ScratchFolder folder;
};

}  // namespace

TEST_CASE("a store of several scans knows how many points each has") {
  const TwoScans scans;
  const StoreReader store(scans.folder / "site.h5");
  CHECK(store.metadata().source_points == Counts{100, 250});
  CHECK(store.metadata().points_of_source(1) == 250u);
  CHECK(faults_of(store).empty());
}

TEST_CASE("a store of one scan has no such dataset, but the answer") {
  const ScratchFolder folder;
  write_las(folder / "a.las", cube_cloud(100, -4000, 4000, 3));
  convert_quietly(conversion_of({folder / "a.las"}, folder / "site.h5"));
  const StoreReader store(folder / "site.h5");
  CHECK(store.metadata().source_points.empty());
  CHECK(store.metadata().points_of_source(0) == 100u);
}

TEST_CASE("a store of several scans without the dataset, as 0.1.0 made it, is read") {
  const TwoScans scans;
  const auto path = scans.folder / "site.h5";
  {
    const hdf5::Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open");
    REQUIRE(H5Ldelete(file.get(), "/sources/points", H5P_DEFAULT) >= 0);
  }
  const StoreReader store(path);
  CHECK_FALSE(store.metadata().points_of_source(0));
}

TEST_CASE("counts of points that do not add up are refused") {
  const TwoScans scans;
  const auto path = scans.folder / "site.h5";
  const auto counts = GENERATE(Counts{100, 251}, Counts{350}, Counts{0, 0}, Counts{351, ~0ull});
  {
    const hdf5::Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open");
    REQUIRE(H5Ldelete(file.get(), "/sources/points", H5P_DEFAULT) >= 0);
    hdf5::write_dataset<std::uint64_t>(file, "/sources/points", counts);
  }
  CHECK_THROWS_WITH(StoreReader(path), Contains("points'"));
}
