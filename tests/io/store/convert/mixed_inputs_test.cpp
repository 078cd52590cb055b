// Inputs of different kinds in one environment: integers with floating-point numbers, and the notes
// on folders and on many files.
#include "core/messages/messages.hpp"
#include "read_environment.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr Quantisation kFine{{0.001, 0.001, 0.001}, {1000, 0, 0}};
constexpr Quantisation kCoarse{{0.01, 0.01, 0.01}, {0, 0, 0}};

}  // namespace

TEST_CASE("floating-point coordinates are rounded to the steps of the files with integers") {
  Inputs inputs;
  inputs.add_las("b.las", std::vector<Quantum>{{1, 2, 3}}, kFine);
  inputs.add_las("c.las", std::vector<Quantum>{{7, 8, 9}}, {{0.001, 0.001, 0.001}, {1001, 0, 0}});
  inputs.add_ply("a.ply", std::vector<Vec3>{{1000.0012, 0.0015, -0.25}});
  inputs.add("d.xyz", "999.9998 nan 0\n1000 0.0004 0\n");
  inputs.options.inputs = {inputs.folder / ""};
  const Environment environment = inputs.read();
  CHECK(environment.quantisation == kFine);
  CHECK(environment.points ==
        std::vector<StoredPoint>{{0, {1, 2, -250}}, {1, {1, 2, 3}}, {2, {1007, 8, 9}}, {4, {}}});
  check_equal(environment.non_finite_points, 1);
  CHECK(environment.largest_change == Approx(0.0005).epsilon(1e-6));
  REQUIRE(codes_of(environment.warnings) == "floating-point-rounded");
  check_says(environment.warnings[0].text, "2 of 4 files ... a.ply ... b.las ... the model?");
}

TEST_CASE("steps that files have, or that are asked for, are those of all") {
  Inputs inputs;
  inputs.add_las("a.las", std::vector<Quantum>{{1, 2, 3}}, kCoarse);
  inputs.add_ply("b.ply", std::vector<Vec3>{{0.004, 0, 0}});
  const Environment rounded = inputs.read();
  CHECK(rounded.quanta() == std::vector<Quantum>{{1, 2, 3}, {0, 0, 0}});
  check_equal(rounded.largest_change, 0.004);
  check_equal(codes_of(rounded.warnings), "floating-point-rounded");
  const Environment asked = inputs.read({.scale = 0.004});
  CHECK(asked.quanta() == std::vector<Quantum>{{2, 5, 8}, {1, 0, 0}});
  check_equal(codes_of(asked.warnings), "");
  for (const auto& input : std::vector(inputs.options.inputs)) {
    inputs.options.inputs = {input, input};
    check_equal(codes_of(inputs.read().warnings), "");  // files of one kind
  }
}

TEST_CASE("a mixture that does not fit the integers, or has two scales, is refused with advice") {
  Inputs inputs;
  inputs.add_ply("far.ply", std::vector<Vec3>{{3e6, 0, 0}});
  inputs.add_las("a.las", std::vector<Quantum>{{0, 0, 0}}, kFine);
  const InputError far = inputs.refused();
  check_says(far.what(), "far.ply ... too far");
  CHECK(far.remedy() == Remedy::kScale);
  check_equal(inputs.read({.scale = 0.01}).points.size(), 2);
  inputs.add_las("b.las", std::vector<Quantum>{{0, 0, 0}}, kCoarse);
  const InputError scales = inputs.refused();
  check_says(scales.what(), "b.las ... a.las");
  CHECK(scales.remedy() == Remedy::kOneScale);
}

TEST_CASE("a folder of 3DTK scans converts with their poses, which are sources too") {
  Inputs inputs;
  std::filesystem::create_directory(inputs.folder / "dat");
  for (const char number : {'0', '1', '2', '3', '4'}) {
    const std::string name = std::string("dat/scan00") + number;
    put_bytes(inputs.folder / (name + ".3d"), "0 0 100\n");
    put_bytes(inputs.folder / (name + ".pose"), std::string("0 0 ") + number + "00\n0 0 0\n");
  }
  put_bytes(inputs.folder / "dat/config.ini", "");
  inputs.options.inputs = {inputs.folder / "dat"};
  const StoreReader store = inputs.store();
  const auto points = points_by_source(store);
  REQUIRE(points.size() == 5);
  for (std::size_t i = 0; i < 5; ++i) {
    const auto& [x, y, z] = points[i];
    check_near(position(store.quantisation(), x, y, z), {1.0 + static_cast<double>(i), 0, 0}, 1e-9);
  }
  REQUIRE(store.metadata().sources.size() == 10);
  check_equal(store.metadata().sources[9].name, "scan004.pose");
  // Three places, and the number of the others.
  check_equal(
      codes_of(inputs.read().warnings),
      "note left-out, note scan-placed, note scan-placed, note scan-placed, note scan-placed");
  NoProgress progress;
  const EnvironmentSource source(inputs.options, progress);
  source.refuse_changed();
  put_bytes(inputs.folder / "dat/scan003.pose", "0 0 301\n0 0 0\n");
  check_refused([&] { source.refuse_changed(); }, "scan003.pose");
}

TEST_CASE("many notes of one kind become three and a number, warnings stay") {
  std::vector<Message> messages;
  for (int i = 0; i < 5; ++i) {
    messages.push_back({Message::Severity::kNote, "a", "note " + std::to_string(i)});
    messages.push_back({Message::Severity::kWarning, "a", "warning"});
    if (i < 3) messages.push_back({Message::Severity::kNote, "b", "other"});
  }
  shorten_notes(messages);
  check_equal(codes_of(messages),
              "note a, a, note b, note a, a, note b, note a, a, note b, a, a, note a");
  check_says(messages.back().text, "2 more notes");
}

// LAZ is read within a conversion's pipeline, whose threads it shares.

TEST_CASE("the store of a LAZ file holds the points of the file in their order") {
  LazBytes laz = laz_bytes(GENERATE(3u, 6u), 150000);
  laz.chunks = {7001};
  Conversion conversion(1000);
  conversion.add("a.laz", laz.build());
  for (const int threads : {1, 2, 4}) {
    conversion.options.threads = threads;
    check_equal(codes_of(conversion.convert().warnings), "");
    const auto points = points_by_source(StoreReader(conversion.options.output));
    CHECK(std::ranges::equal(points, laz.points, {}, {}, &LazPoint::position));
  }
}

TEST_CASE("a damaged chunk ends a conversion with the chunk's number, by any number of threads") {
  LazBytes laz = laz_bytes(6, 60000);
  laz.chunks = {7001};
  std::string bytes = laz.build();
  for (std::size_t at = bytes.size() / 2; at < bytes.size() - 200; ++at) bytes[at] = 'x';
  Conversion conversion;
  conversion.add("a.laz", bytes);
  const std::string first = conversion.refusal();
  check_says(first, "a.laz: chunk ");
  for (const int threads : {1, 4}) {
    conversion.options.threads = threads;
    check_equal(conversion.refusal(), first);
  }
}
