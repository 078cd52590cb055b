// A scan in whose lane withheld points lie.
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("withheld points in the lane are left out and counted, unless they are to be kept") {
  const ScratchFolder folder;
  ConversionOptions options =
      conversion_of({data_folder() / "cases" / "f3_withheld.las"}, folder / "a.h5");
  const ConversionReport left_out = convert_quietly(options);
  check_equal(left_out.withheld_points, 18);
  check_equal(left_out.points, 147);
  REQUIRE(left_out.warnings.size() == 1);
  check_equal(left_out.warnings[0].code, "withheld-points");
  CHECK_FALSE(StoreReader(options.output).metadata().withheld->cubes.empty());
  options.keep_withheld = true;
  const ConversionReport kept = convert_quietly(options);
  check_equal(kept.points, 165);
  check_equal(kept.kept_withheld_points, 18);
}
