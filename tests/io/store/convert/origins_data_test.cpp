// Origins and withheld points of real scans against what their files say.
#include <cmath>

#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

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
  Conversion conversion(4096);
  conversion.options.inputs = {data_folder() / "formats" / known.file};
  const StoreReader store = conversion.store();
  const Quantisation& q = store.quantisation();
  OriginQuanta at{};
  for (std::size_t k = 0; k < 3; ++k) {
    at[k] = std::llround((known.at[k] - q.offset[k]) / q.scale[k]);
  }
  const StoreOrigins& origins = store.metadata().origins.value();
  CHECK(origins.quanta == std::vector<OriginQuanta>{at});
  CHECK(origins.rest_on == std::vector<OriginBasis>{{known.what, store.point_count()}});
}

TEST_CASE("a scan of PCD whose VIEWPOINT is the default has no origin") {
  Conversion conversion(4096);
  conversion.options.inputs = {data_folder() / "formats" / "autzen-utm.pcd"};
  CHECK_FALSE(conversion.store().has_origins());
}

TEST_CASE("withheld points in the lane are left out and counted, unless they are to be kept") {
  Conversion conversion;
  conversion.options.inputs = {data_folder() / "cases" / "f3_withheld.las"};
  const ConversionReport left_out = conversion.convert();
  check_equal(left_out.withheld_points, 18);
  check_equal(left_out.points, 147);
  check_equal(codes_of(left_out.warnings), "withheld-points");
  CHECK_FALSE(StoreReader(conversion.options.output).metadata().withheld->cubes.empty());
  conversion.options.keep_withheld = true;
  const ConversionReport kept = conversion.convert();
  check_equal(kept.points, 165);
  check_equal(kept.kept_withheld_points, 18);
}
