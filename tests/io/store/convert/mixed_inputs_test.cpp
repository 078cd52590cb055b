// Inputs of different kinds in one environment: integers with floating-point numbers, and the notes
// on folders and on many files.
#include <cmath>

#include "core/messages/messages.hpp"
#include "read_environment.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

Quantisation mixed_millimetres_from(double x, double y, double z) {
  return {{0.001, 0.001, 0.001}, {x, y, z}};
}

const Message* find(const std::vector<Message>& messages, const std::string& code) {
  for (const Message& message : messages) {
    if (message.code == code) return &message;
  }
  return nullptr;
}

}  // namespace

TEST_CASE("floating-point coordinates are rounded to the steps of the files with integers") {
  const ScratchFolder folder;
  write_las(folder / "b.las", std::vector<Quantum>{{1, 2, 3}}, mixed_millimetres_from(1000, 0, 0));
  write_las(folder / "c.las", std::vector<Quantum>{{7, 8, 9}}, mixed_millimetres_from(1001, 0, 0));
  write_ply(folder / "a.ply", std::vector<Vec3>{{1000.0012, 0.0015, -0.25}});
  put_bytes(folder / "d.xyz", "999.9998 nan 0\n1000 0.0004 0\n");
  const Environment environment = read_environment({folder / ""});
  CHECK(environment.quantisation == mixed_millimetres_from(1000, 0, 0));
  REQUIRE(environment.points.size() == 4);
  CHECK(environment.points[0] == StoredPoint{0, {1, 2, -250}});
  CHECK(environment.points[1] == StoredPoint{1, {1, 2, 3}});
  CHECK(environment.points[2] == StoredPoint{2, {1007, 8, 9}});
  CHECK(environment.points[3] == StoredPoint{4, {0, 0, 0}});
  check_equal(environment.non_finite_points, 1);
  CHECK(environment.largest_change == Approx(0.0005).epsilon(1e-6));
  const Message* note = find(environment.warnings, "floating-point-rounded");
  REQUIRE(note);
  CHECK(note->severity == Message::Severity::kWarning);
  check_says(note->text, "2 of 4 files ... a.ply ... b.las ... the model?");
}

TEST_CASE("rounding to coarse steps of other files is warned of") {
  const ScratchFolder folder;
  write_las(folder / "a.las", std::vector<Quantum>{{1, 2, 3}}, {{0.01, 0.01, 0.01}, {0, 0, 0}});
  write_ply(folder / "a.ply", std::vector<Vec3>{{0.004, 0, 0}});
  const Environment environment = read_environment({folder / "a.las", folder / "a.ply"});
  CHECK(environment.points[1].q == Quantum{0, 0, 0});
  check_equal(environment.largest_change, 0.004);
  const Message* warning = find(environment.warnings, "floating-point-rounded");
  REQUIRE(warning);
  CHECK(warning->severity == Message::Severity::kWarning);
}

TEST_CASE("files of one kind are not remarked on, nor those for which a scale was asked") {
  const ScratchFolder folder;
  write_las(folder / "a.las", std::vector<Quantum>{{1, 2, 3}}, mixed_millimetres_from(0, 0, 0));
  write_ply(folder / "a.ply", std::vector<Vec3>{{0.001, 0.002, 0.003}});
  CHECK(read_environment({folder / "a.las", folder / "a.las"}).warnings.empty());
  CHECK(read_environment({folder / "a.ply", folder / "a.ply"}).warnings.empty());
  const Environment environment =
      read_environment({folder / "a.ply", folder / "a.las"}, {.scale = 0.01});
  CHECK(environment.warnings.empty());
  check_equal(environment.quantisation.scale[0], 0.01);
  REQUIRE(environment.points.size() == 2);
  CHECK(environment.points[0].q == environment.points[1].q);
}

TEST_CASE("a mixture that does not fit the integers, or has two scales, is refused with advice") {
  const ScratchFolder folder;
  write_las(folder / "a.las", std::vector<Quantum>{{0, 0, 0}}, mixed_millimetres_from(0, 0, 0));
  write_las(folder / "b.las", std::vector<Quantum>{{0, 0, 0}}, {{0.01, 0.01, 0.01}, {0, 0, 0}});
  write_ply(folder / "far.ply", std::vector<Vec3>{{3e6, 0, 0}});
  const auto far = refused({folder / "a.las", folder / "far.ply"});
  REQUIRE(far);
  check_says(far->what(), "far.ply ... too far");
  CHECK(far->remedy() == Remedy::kScale);
  const auto scales = refused({folder / "far.ply", folder / "a.las", folder / "b.las"});
  REQUIRE(scales);
  check_says(scales->what(), "b.las ... a.las");
  CHECK(scales->remedy() == Remedy::kOneScale);
  CHECK(read_environment({folder / "a.las", folder / "far.ply"}, {.scale = 0.01}).points.size() ==
        2);
}

TEST_CASE("a folder of 3DTK scans converts with their poses, which are sources too") {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "dat");
  for (const char* number : {"0", "1", "2", "3", "4"}) {
    put_bytes(folder / ("dat/scan00" + std::string(number) + ".3d"), "0 0 100\n");
    put_bytes(folder / ("dat/scan00" + std::string(number) + ".pose"),
              "0 0 " + std::string(number) + "00\n0 0 0\n");
  }
  put_bytes(folder / "dat/config.ini", "");
  const ConversionOptions options = conversion_of({folder / "dat"}, folder / "a.h5");
  convert_quietly(options);
  const StoreReader store(folder / "a.h5");
  const auto points = points_by_source(store);
  REQUIRE(points.size() == 5);
  for (std::size_t i = 0; i < 5; ++i) {
    const Vec3 p =
        position(store.metadata().quantisation, points[i][0], points[i][1], points[i][2]);
    CHECK(p.x == Approx(1.0 + static_cast<double>(i)));
    check_equal(p.y, 0);
  }
  REQUIRE(store.metadata().sources.size() == 10);
  check_equal(store.metadata().sources[9].name, "scan004.pose");
  NoProgress progress;
  CHECK(is_converted(options, progress));
  put_bytes(folder / "dat/scan003.pose", "0 0 301\n0 0 0\n");
  CHECK_FALSE(is_converted(options, progress));

  const auto remarks = read_environment({folder / "dat"}).warnings;
  CHECK(find(remarks, "left-out"));
  std::size_t placed = 0;
  for (const Message& remark : remarks) placed += remark.code == "scan-placed";
  check_equal(placed, 4);  // three places, and the number of the others
}

TEST_CASE("a pose that changes during the conversion is noticed") {
  const ScratchFolder folder;
  put_bytes(folder / "scan000.3d", "0 0 100\n");
  put_bytes(folder / "scan000.pose", "0 0 0 0 0 0\n");
  NoProgress progress;
  const EnvironmentSource source({folder / "scan000.3d"}, {}, progress);
  source.refuse_changed();
  put_bytes(folder / "scan000.pose", "0 0 100 0 0 0\n");
  check_refused([&] { return source.refuse_changed(); }, "scan000.pose");
}

TEST_CASE("many notes of one kind become three and a number, warnings stay") {
  std::vector<Message> messages;
  for (int i = 0; i < 5; ++i) {
    messages.push_back({Message::Severity::kNote, "a", "note " + std::to_string(i)});
    messages.push_back({Message::Severity::kWarning, "a", "warning"});
    if (i < 3) messages.push_back({Message::Severity::kNote, "b", "other"});
  }
  shorten_notes(messages);
  REQUIRE(messages.size() == 3 + 5 + 3 + 1);
  check_equal(messages.back().code, "a");
  check_says(messages.back().text, "2 more notes");
}

// LAZ is read within a conversion's pipeline, whose threads it shares.

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
    check_says(message, "a.laz: chunk ");
    if (first.empty()) first = message;
    CHECK(message == first);
  }
}
