// Inputs that cannot be read among others that can, and texts whose columns are chosen.
#include "io/store/convert/convert.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
namespace fs = std::filesystem;

namespace {

struct UnreadableScans {
  ScratchFolder folder;
  ConversionOptions options;

  UnreadableScans() {
    fs::create_directory(folder / "scans");
    for (const std::string name : {"a", "b", "c", "d"}) {
      std::vector<Quantum> points;
      for (int i = 0; i < 10; ++i) points.push_back({name[0], 2, i});
      write_las(folder / ("scans/" + name + ".las"), points);
    }
    options = conversion_of({folder / "scans"}, folder / "out.h5");
  }
};

}  // namespace

TEST_CASE("one unreadable file is refused, and the remedy named") {
  const UnreadableScans scans;
  put_bytes(scans.folder / "scans/b.las", "LASF, but nothing else");
  try {
    convert_quietly(scans.options);
    FAIL("converted");
  } catch (const InputError& error) {
    check_says(error.what(), "b.las");
    CHECK(error.remedy() == Remedy::kSkipUnreadable);
  }
  try {
    ConversionOptions alone = scans.options;
    alone.inputs = {scans.folder / "scans/b.las"};
    convert_quietly(alone);
    FAIL("converted");
  } catch (const InputError& error) {
    CHECK(error.remedy() == Remedy::kNone);
  }
}

TEST_CASE("unreadable files are left out where that is asked for, and listed") {
  UnreadableScans scans;
  put_bytes(scans.folder / "scans/b.las", "LASF, but nothing else");
  // The first points of this file are sound, and the fault comes later.
  put_bytes(scans.folder / "scans/c.las",
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty "
            "float x\nproperty float y\nproperty float z\n"
            "end_header\n1 2 3\n");
  scans.options.skip_unreadable = true;
  const ConversionReport report = convert_quietly(scans.options);
  check_equal(report.points, 20);
  REQUIRE(report.metadata.sources.size() == 2);
  check_equal(report.metadata.sources[0].name, "a.las");
  check_equal(report.metadata.sources[1].name, "d.las");
  REQUIRE(report.warnings.size() == 1);
  check_equal(report.warnings[0].code, "skipped-files");
  check_says(report.warnings[0].text, "2 files are left out ... b.las ... c.las: ends");
  NoProgress progress;
  CHECK(is_converted(scans.options, progress));
  scans.options.strict = true;
  check_says(conversion_refusal<InputError>(scans.options), "skipped-files");
}

TEST_CASE("nothing is left out silently where all files can be read, or none") {
  UnreadableScans scans;
  scans.options.skip_unreadable = true;
  CHECK(convert_quietly(scans.options).warnings.empty());
  for (const std::string name : {"a", "b", "c", "d"}) {
    put_bytes(scans.folder / ("scans/" + name + ".las"), "LASF");
  }
  check_says(conversion_refusal<InputError>(scans.options), "none of the 4 files ... a.las");
  scans.options.inputs = {scans.folder / "missing.las"};
  CHECK_FALSE(conversion_refusal<ResourceError>(scans.options).empty());
}

TEST_CASE("the columns chosen apply to texts, and are refused where there is none") {
  const ScratchFolder folder;
  put_bytes(folder / "a.csv", "id,up,right,on\n1,30,1,2\n2,60,4,5\n");
  write_ply(folder / "b.ply", std::vector<Vec3>{{7, 8, 9}});
  ConversionOptions options =
      conversion_of({folder / "a.csv", folder / "b.ply"}, folder / "out.h5");
  options.columns = {"right", "4", "up"};
  const ConversionReport report = convert_quietly(options);
  check_equal(report.points, 3);
  REQUIRE(report.box);
  CHECK(report.box->lo == Vec3{1, 2, 9});
  CHECK(report.box->hi == Vec3{7, 8, 60});
  NoProgress progress;
  CHECK(is_converted(options, progress));
  std::swap(options.columns[0], options.columns[1]);
  CHECK_FALSE(is_converted(options, progress));
  options.inputs = {folder / "b.ply"};
  check_says(conversion_refusal<UsageError>(options), "no input is a text");
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"1", "2"}, {"1", "2", "0"}, {"x", "y", "x"}, {"x", "", "z"}}) {
    options.columns = wrong;
    check_says(conversion_refusal<UsageError>(options), "three different columns");
  }
}
