// Inputs that cannot be read among others that can, and texts whose columns are chosen.
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
namespace fs = std::filesystem;

namespace {

/// A folder of four scans of ten points.
struct UnreadableScans : Conversion {
  UnreadableScans() {
    fs::create_directory(folder / "scans");
    for (const std::string name : {"a", "b", "c", "d"}) {
      std::vector<Quantum> points;
      for (int i = 0; i < 10; ++i) points.push_back({name[0], 2, i});
      write_las(folder / ("scans/" + name + ".las"), points);
    }
    options.inputs = {folder / "scans"};
  }
  void spoil(const std::string& name, const std::string& bytes = "LASF, but nothing else") const {
    put_bytes(folder / ("scans/" + name + ".las"), bytes);
  }
  Remedy remedy() const {
    try {
      convert();
    } catch (const InputError& error) {
      check_says(error.what(), "b.las");
      return error.remedy();
    }
    FAIL("converted");
    return Remedy::kNone;
  }
};

}  // namespace

TEST_CASE("one unreadable file is refused, and the remedy named") {
  UnreadableScans scans;
  scans.spoil("b");
  CHECK(scans.remedy() == Remedy::kSkipUnreadable);
  scans.options.inputs = {scans.folder / "scans/b.las"};
  CHECK(scans.remedy() == Remedy::kNone);
}

TEST_CASE("unreadable files are left out where that is asked for, and listed") {
  UnreadableScans scans;
  scans.options.skip_unreadable = true;
  check_equal(codes_of(scans.convert().warnings), "");
  scans.spoil("b");
  // The first points of this file are sound, and the fault comes later.
  scans.spoil("c",
              "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
              "property float z\nend_header\n1 2 3\n");
  const ConversionReport report = scans.convert();
  check_equal(report.points, 20);
  REQUIRE(report.metadata.sources.size() == 2);
  check_equal(report.metadata.sources[0].name, "a.las");
  check_equal(report.metadata.sources[1].name, "d.las");
  REQUIRE(codes_of(report.warnings) == "skipped-files");
  check_says(report.warnings[0].text, "2 files are left out ... b.las ... c.las: ends");
  for (const char* name : {"a", "d"}) scans.spoil(name);
  check_says(scans.refusal(), "none of the 4 files ... a.las");
  scans.options.inputs = {scans.folder / "missing.las"};
  check_says(scans.refusal<ResourceError>(), "missing.las");
}

TEST_CASE("the columns chosen apply to texts, and are refused where there is none") {
  Conversion conversion;
  conversion.add("a.csv", "id,up,right,on\n1,30,1,2\n2,60,4,5\n");
  conversion.add_ply("b.ply", std::vector<Vec3>{{7, 8, 9}});
  conversion.options.columns = {"right", "4", "up"};
  const ConversionReport report = conversion.convert();
  check_equal(report.points, 3);
  CHECK(report.box.value().lo == Vec3{1, 2, 9});
  CHECK(report.box->hi == Vec3{7, 8, 60});
  conversion.options.inputs = {conversion.folder / "b.ply"};
  check_says(conversion.refusal<UsageError>(), "no input is a text");
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"1", "2"}, {"1", "2", "0"}, {"x", "y", "x"}, {"x", "", "z"}}) {
    conversion.options.columns = wrong;
    check_says(conversion.refusal<UsageError>(), "three different columns");
  }
}
