// Origins of real scans against what their files say.
#include <cmath>
#include <fstream>

#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/origins.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

OriginQuanta quanta_of(const StoreReader& store, const std::array<double, 3>& at) {
  const Quantisation& q = store.quantisation();
  OriginQuanta out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = std::llround((at[k] - q.offset[k]) / q.scale[k]);
  return out;
}

}  // namespace

TEST_CASE("the points of the street have the origins of the file beside it") {
  const ScratchFolder folder;
  ConversionOptions options =
      conversion_of({data_folder() / "street" / "street.las"}, folder / "a.h5", 65536);
  options.origins = data_folder() / "street" / "origins.csv";
  convert_quietly(options);
  const StoreReader store(options.output);
  check_equal(store.metadata().origins->points_without, 0);
  const auto by_source = origins_by_source(store);
  std::ifstream file(options.origins);
  std::string header;
  std::getline(file, header);
  std::size_t rows = 0, source = 0, wrong = 0;
  std::optional<OriginQuanta> expected;
  const auto check_before = [&](std::size_t end) {
    for (; source < end; ++source) wrong += by_source[source] != expected;
  };
  std::size_t first = 0;
  std::array<double, 3> at{};
  char comma = 0;
  while (file >> first >> comma >> at[0] >> comma >> at[1] >> comma >> at[2]) {
    check_before(first);
    expected = quanta_of(store, at);
    ++rows;
  }
  check_before(by_source.size());
  check_equal(rows, 154);
  check_equal(source, 4629906);
  check_equal(wrong, 0);
  CHECK(faults_of(store).empty());
}

TEST_CASE("real scans of E57, PTX and 3DTK have the places of their scanners as origins") {
  struct Known {
    const char* file;
    std::array<double, 3> at;
    const char* what;
  };
  const Known known = GENERATE(
      Known{"pye57_translationWithoutRotation.e57", {4, 5, 6}, "poses of E57"},
      Known{"cry_tiny_spherical.e57", {0, 0, 0}, "poses of E57"},
      Known{"complex-transform.ptx", {-3.028748, -3.819741, -1.384333}, "scanner positions of PTX"},
      Known{"3dtk/scan000.3d", {0, 0, 0}, "poses of 3DTK"});
  const ScratchFolder folder;
  const ConversionOptions options =
      conversion_of({data_folder() / "formats" / known.file}, folder / "a.h5", 4096);
  convert_quietly(options);
  const StoreReader store(options.output);
  REQUIRE(store.has_origins());
  const StoreOrigins& origins = *store.metadata().origins;
  CHECK(origins.quanta == std::vector<OriginQuanta>{quanta_of(store, known.at)});
  CHECK(origins.rest_on == std::vector<OriginBasis>{{known.what, store.point_count()}});
}

TEST_CASE("a scan of PCD whose VIEWPOINT is the default has no origin") {
  const ScratchFolder folder;
  const ConversionOptions options =
      conversion_of({data_folder() / "formats" / "autzen-utm.pcd"}, folder / "a.h5", 4096);
  convert_quietly(options);
  CHECK_FALSE(StoreReader(options.output).has_origins());
}
