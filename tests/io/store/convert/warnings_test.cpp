// Conversions warn where something is wrong with the inputs, and only there.
#include <cmath>
#include <fstream>
#include <functional>
#include <random>
#include <set>

#include "core/util/format.hpp"
#include "io/store/convert/convert.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
namespace fs = std::filesystem;

namespace {

std::vector<Quantum> scan(std::size_t points, unsigned seed, std::int32_t lo = 0,
                          std::int32_t hi = 50'000) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int32_t> coordinate(lo, hi);
  std::vector<Quantum> out(points);
  for (Quantum& q : out) q = {coordinate(random), coordinate(random), coordinate(random) / 10};
  return out;
}

struct Folder {
  ScratchFolder folder;

  fs::path add(const std::string& name, const std::vector<Quantum>& points,
               const Quantisation& quantisation = kMillimetres) const {
    write_las(folder / name, points, quantisation);
    return folder / name;
  }

  ConversionOptions options(std::vector<fs::path> inputs) const {
    return conversion_of(std::move(inputs), folder / "out.h5");
  }

  std::vector<Message> warnings(std::vector<fs::path> inputs) const {
    return convert_quietly(options(std::move(inputs))).warnings;
  }
};

double number(const Message& message, const std::string& name) {
  for (const auto& [key, value] : message.numbers) {
    if (key == name) return value;
  }
  FAIL("no number " << name);
  return 0;
}

/// The only warning, which has to have this code.
Message only(const std::vector<Message>& warnings, const std::string& code) {
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].code == code);
  CHECK(warnings[0].severity == Message::Severity::kWarning);
  return warnings[0];
}

}  // namespace

TEST_CASE("ordinary scans convert without a warning") {
  const Folder folder;
  const fs::path a = folder.add("a.las", scan(20'000, 1));
  const fs::path b = folder.add("b.las", scan(300, 2, 40'000, 90'000));
  const fs::path c = folder.add("c.las", scan(5, 3), {{0.001, 0.001, 0.001}, {900, -200, 0}});
  CHECK(folder.warnings({a, b, c}).empty());
  ConversionOptions options = folder.options({a, b, c});
  options.strict = true;
  const ConversionReport report = convert_quietly(options);
  check_equal(report.points, 20'305);
  CHECK(report.scale == Vec3{0.001, 0.001, 0.001});
  CHECK(report.offset == Vec3{100, -200, 0});
  REQUIRE(report.box);
  CHECK(report.box->lo.x >= 100);
  CHECK(report.box->hi.x > 900);
}

TEST_CASE("many points at one place are counted exactly, wherever they stand") {
  const Folder folder;
  // Below and above the number of points up to which all are examined.
  const std::size_t many = GENERATE(std::size_t{50'000}, std::size_t{300'000});
  const std::string how = GENERATE("at the end", "every seventh", "at random");
  std::vector<Quantum> points = scan(many, 4, 1, 50'000);
  std::mt19937 random(5);
  std::size_t zeros = 0, first = points.size(), last = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool zero = how == "at the end"      ? i >= points.size() / 2
                      : how == "every seventh" ? i % 7 == 3
                                               : random() % 50 == 0;
    if (!zero) continue;
    points[i] = {0, 0, 0};
    first = std::min(first, i);
    last = i;
    ++zeros;
  }
  const fs::path a = folder.add("a.las", scan(1000, 6, 1, 50'000));
  const fs::path b = folder.add("b.las", points);
  const Message warning = only(folder.warnings({a, b}), "same-place");
  CHECK(number(warning, "points") == static_cast<double>(zeros));
  CHECK(number(warning, "share") ==
        Approx(static_cast<double>(zeros) / static_cast<double>(many + 1000)));
  check_equal(number(warning, "x"), 100);
  check_says(warning.text, "100 -200 0 ... b.las ... zeros in the file");
  check_says(warning.text, std::string("point ") + format_count(first) + " ( ... point " +
                               format_count(last) + " (");
}

TEST_CASE("a place that is not the origin is no half-copied file") {
  const Folder folder;
  std::vector<Quantum> points = scan(50'000, 7);
  for (std::size_t i = 100; i < 1100; ++i) points[i] = {1234, 5678, 90};
  const Message warning = only(folder.warnings({folder.add("a.las", points)}), "same-place");
  check_equal(number(warning, "points"), 1000);
  check_says(warning.text, "101.234 -194.322 0.09");
  check_lacks(warning.text, "half");
}

TEST_CASE("few points at one place, and a small share, are not told") {
  const Folder folder;
  std::vector<Quantum> points = scan(40, 8);
  for (std::size_t i = 0; i < 9; ++i) points[i] = {1, 2, 3};
  CHECK(folder.warnings({folder.add("a.las", points)}).empty());
  points[9] = {1, 2, 3};
  only(folder.warnings({folder.add("a.las", points)}), "same-place");
  points = scan(200'000, 8);
  for (std::size_t i = 0; i < 1990; ++i) points[i] = {1, 2, 3};
  CHECK(folder.warnings({folder.add("a.las", points)}).empty());
}

TEST_CASE("zeros in a floating-point file are told too") {
  const Folder folder;
  std::vector<Vec3> points(4000);
  for (std::size_t i = 0; i < 2000; ++i) points[i] = {0.001 * static_cast<double>(i) + 3, 4, 5};
  write_ply(folder.folder / "a.ply", points);
  const Message warning = only(folder.warnings({folder.folder / "a.ply"}), "same-place");
  check_says(warning.text, "50 % ... zeros in the file");
}

TEST_CASE("warnings do not depend on threads") {
  const Folder folder;
  std::vector<Quantum> points = scan(400'000, 9);
  for (std::size_t i = 0; i < points.size(); i += 17) points[i] = {7, 7, 7};
  const fs::path a = folder.add("a.las", points);
  std::vector<std::string> texts;
  for (const int threads : {1, 2, 5}) {
    ConversionOptions options = folder.options({a, a});
    options.threads = threads;
    std::string text;
    for (const Message& warning : convert_quietly(options).warnings) text += warning.text + "|";
    texts.push_back(text);
  }
  check_says(texts[0], "same file ... one place");
  CHECK(texts[1] == texts[0]);
  CHECK(texts[2] == texts[0]);
}

TEST_CASE("a scan that is given twice is told, by whatever names") {
  const Folder folder;
  const fs::path a = folder.add("a.las", scan(500, 10));
  const fs::path b = folder.add("b.las", scan(500, 11));
  const fs::path copy = folder.folder / "copy.las";
  CHECK(folder.warnings({a, b}).empty());
  SECTION("the same name") {
    const Message warning = only(folder.warnings({a, b, a}), "same-scan");
    check_says(warning.text, "same file ... 500 points");
    check_equal(number(warning, "files"), 1);
  }
  SECTION("a link") {
    GENERATE(0, 1) == 0 ? fs::create_symlink(a, copy) : fs::create_hard_link(a, copy);
    check_says(only(folder.warnings({a, b, copy}), "same-scan").text,
               "copy.las is the same file as");
  }
  SECTION("a copy") {
    fs::copy_file(a, copy);
    check_says(only(folder.warnings({b, copy, a}), "same-scan").text,
               "a.las has the same bytes as");
  }
}

TEST_CASE("one file in another frame is told") {
  const Folder folder;
  std::vector<fs::path> files;
  for (int i = 0; i < 4; ++i) {
    files.push_back(folder.add("a" + std::to_string(i) + ".las", scan(100, 20 + i),
                               {{0.001, 0.001, 0.001}, {500'000.0 + 40 * i, 0, 0}}));
  }
  CHECK(folder.warnings(files).empty());
  files.insert(files.begin() + 2,
               folder.add("local.las", scan(100, 30), {{0.001, 0.001, 0.001}, {0, 0, 0}}));
  const Message warning = only(folder.warnings(files), "far-apart");
  check_says(warning.text, "local.las lies ... frame");
  check_equal(number(warning, "files"), 1);
  CHECK(number(warning, "gap") > 400'000);
}

TEST_CASE("tiles of a long road are not apart") {
  const Folder folder;
  std::vector<fs::path> files;
  for (int i = 0; i < 60; ++i) {
    files.push_back(folder.add("t" + std::to_string(100 + i) + ".las", scan(50, 40 + i, 0, 10'000),
                               {{0.001, 0.001, 0.001}, {500.0 * i, 0, 0}}));
  }
  CHECK(folder.warnings(files).empty());
}

TEST_CASE("one file in millimetres is told") {
  const Folder folder;
  const fs::path a = folder.add("a.las", scan(100, 50), {{0.001, 0.001, 0.001}, {0, 0, 0}});
  std::vector<Quantum> large = scan(100, 50);
  for (Quantum& q : large) {
    for (std::int32_t& v : q) v *= 1000;
  }
  const fs::path b = folder.add("mm.las", large, {{0.001, 0.001, 0.001}, {0, 0, 0}});
  const Message warning =
      only(folder.warnings(
               {a, b, folder.add("c.las", scan(100, 51), {{0.001, 0.001, 0.001}, {0, 0, 0}})}),
           "other-size");
  check_says(warning.text, "mm.las ... millimetres");
  CHECK(number(warning, "ratio") == Approx(1000).epsilon(0.1));
}

TEST_CASE("inputs without points are told") {
  const Folder folder;
  const fs::path a = folder.add("a.las", scan(100, 60));
  const fs::path none = folder.add("none.las", {});
  CHECK_THAT(only(folder.warnings({a, none}), "no-points").text,
             Contains("none.las") && !Contains("nothing can collide"));
  check_says(only(folder.warnings({none}), "no-points").text, "nothing can collide");
}

TEST_CASE("points that are not finite are told with their share and the first") {
  const Folder folder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  write_ply(folder.folder / "a.ply", std::vector<Vec3>{{1, 2, 3}, {1, 2, 4}});
  write_ply(folder.folder / "b.ply", std::vector<Vec3>{{1, 2, 5}, {nan, 0, 0}});
  const Message warning = only(folder.warnings({folder.folder / "a.ply", folder.folder / "b.ply"}),
                               "non-finite-points");
  check_says(warning.text, "25 % ... point 1 ... b.ply");
  check_equal(number(warning, "share"), 0.25);
}

TEST_CASE("a strict conversion tells all warnings and leaves nothing behind") {
  const Folder folder;
  std::vector<Quantum> points(3000);
  const fs::path a = folder.add("a.las", points);
  ConversionOptions options = folder.options({a, a});
  options.strict = true;
  std::vector<std::string> told;
  options.message = [&told](const Message& message) {
    if (message.severity == Message::Severity::kWarning) told.push_back(message.code);
  };
  CHECK(conversion_refusal<InputError>(options) ==
        "strict: 2 warnings (same-scan, same-place), expected none; no output was written");
  check_equal(told, {"same-scan", "same-place"});
  CHECK_FALSE(fs::exists(options.output));
  CHECK_FALSE(fs::exists(folder.folder / "out.h5.partial"));
}

namespace {

using Round = std::function<Vec3(const Vec3&)>;

/// A road of 40 x 8 m with a fence on either side, as a scanner sees them.
std::vector<Vec3> street(std::size_t points, const Vec3& at, const Round& round) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < points; ++i) {
    const double x = 40 * share(random), y = 8 * share(random), z = 0.05 * share(random);
    const bool fence = i % 3 == 0;
    out.push_back(round(at + Vec3{x, fence ? (y < 4 ? 0.2 : 7.8) + z : y, fence ? y / 3 : z}));
  }
  return out;
}

double to(double value, double step, double offset = 0) {
  return std::round((value - offset) / step) * step + offset;
}

/// One point for each place of a grid of 60 x 60 on a hill, turned about z.
std::vector<Vec3> terrain(double step, double turn, const Vec3& at) {
  std::vector<Vec3> out;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) {
      const double x = step * i, y = step * j;
      out.push_back(at + Vec3{std::cos(turn) * x - std::sin(turn) * y,
                              std::sin(turn) * x + std::cos(turn) * y,
                              3 * std::sin(0.11 * i) * std::cos(0.07 * j)});
    }
  }
  return out;
}

/// The centres of the voxels that hold points.
std::vector<Vec3> voxels(const std::vector<Vec3>& points, double step) {
  std::set<std::array<std::int64_t, 3>> places;
  for (const Vec3& p : points) {
    places.insert({std::llround(p.x / step), std::llround(p.y / step), std::llround(p.z / step)});
  }
  std::vector<Vec3> out;
  for (const auto& [x, y, z] : places) {
    out.push_back({step * static_cast<double>(x), step * static_cast<double>(y),
                   step * static_cast<double>(z)});
  }
  return out;
}

struct SteppedScan {
  Folder folder;
  ConversionOptions options = folder.options({});

  SteppedScan() { options.overwrite = true; }

  void add_text(const std::string& name, const std::vector<Vec3>& points) {
    std::string lines;
    for (const Vec3& p : points) {
      lines += format_number(p.x) + " " + format_number(p.y) + " " + format_number(p.z) + "\n";
    }
    put_bytes(folder.folder / name, lines);
    options.inputs.push_back(folder.folder / name);
  }

  /// Adds points that the pose of their scan turns about z.
  void add_ptx(const std::string& name, const std::vector<Vec3>& points, double turn) {
    const std::string x =
        format_number(std::cos(turn)) + " " + format_number(std::sin(turn)) + " 0";
    const std::string y =
        format_number(-std::sin(turn)) + " " + format_number(std::cos(turn)) + " 0";
    std::string text = std::to_string(points.size()) + "\n1\n7 8 9\n" + x + "\n" + y + "\n0 0 1\n" +
                       x + " 0\n" + y + " 0\n0 0 1 0\n7 8 9 1\n";
    for (const Vec3& p : points) {
      text += format_number(p.x) + " " + format_number(p.y) + " " + format_number(p.z) + " 0.5\n";
    }
    put_bytes(folder.folder / name, text);
    options.inputs.push_back(folder.folder / name);
  }

  void add_las(const std::string& name, const std::vector<Vec3>& points) {
    std::vector<Quantum> quanta;
    for (const Vec3& p : points) {
      Quantum& q = quanta.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const double steps =
            (p[static_cast<int>(k)] - kMillimetres.offset[k]) / kMillimetres.scale[k];
        q[k] = static_cast<std::int32_t>(std::lround(steps));
      }
    }
    options.inputs.push_back(folder.add(name, quanta));
  }

  /// The steps that the store has.
  std::array<double, 3> steps() {
    warnings = convert_quietly(options).warnings;
    const StoreReader store(options.output);
    CHECK(faults_of(store).empty());
    options.inputs.clear();
    return store.metadata().steps;
  }

  std::vector<Message> warnings;
};

}  // namespace

TEST_CASE("a store has the steps to which coordinates were rounded, whatever the offset") {
  const Vec3 at{300, 500, 3};
  const auto [round, x, y, z] = GENERATE(table<Round, double, double, double>({
      {[](const Vec3& p) {
         return Vec3{p.x, to(p.y, 0.5), p.z};
       },
       0, 0.5, 0},
      {[](const Vec3& p) {
         return Vec3{p.x, to(p.y, 0.5, 0.37), p.z};
       },
       0, 0.5, 0},
      {[](const Vec3& p) {
         return Vec3{to(p.x, 0.3048), to(p.y, 0.3048), p.z};
       },
       0.3048, 0.3048, 0},
      {[](const Vec3& p) {
         return Vec3{to(p.x, 0.5), to(p.y, 0.25, 0.1), to(p.z, 0.07)};
       },
       0.5, 0.25, 0.07},
      {[](const Vec3& p) {
         return Vec3{static_cast<float>(p.x), to(p.y, 0.1), static_cast<float>(p.z)};
       },
       0, 0.1, 0},
  }));
  SteppedScan scan;
  const bool as_text = GENERATE(false, true);
  const std::vector<Vec3> points = street(20'000, at, round);
  if (as_text) {
    scan.add_text("a.xyz", points);
  } else {
    scan.add_las("a.las", points);
  }
  CAPTURE(as_text, x, y, z);
  const std::array expected{x, y, z};
  const std::array<double, 3> found = scan.steps();
  for (std::size_t k = 0; k < 3; ++k) {
    if (expected[k] > 0) CHECK(found[k] == Approx(expected[k]).epsilon(1e-3));
    if (expected[k] == 0) CHECK((found[k] > 0 && found[k] <= 0.001));
  }
  check_equal(number(only(scan.warnings, "lost-digits"), "raster"), 0);
}

TEST_CASE("steps are those of the coarsest input, of the kept points and of the store") {
  const Vec3 at{300, 500, 3};
  const auto fine = street(9000, at, [](const Vec3& p) { return p; });
  const auto coarse = street(9000, at + Vec3{0, 20, 0}, [](const Vec3& p) {
    return Vec3{p.x, to(p.y, 0.5), p.z};
  });
  SteppedScan scan;
  scan.add_las("fine.las", fine);
  scan.add_las("coarse.las", coarse);
  CHECK(scan.steps()[1] == Approx(0.5));
  scan.options.inputs = {scan.folder.folder / "fine.las", scan.folder.folder / "coarse.las"};
  scan.options.near = scan.folder.folder.write("p.txt", "1 0 0 310 0 1 0 505 0 0 1 3 0 0 0 1\n");
  scan.options.within = 5;
  CHECK(scan.steps()[1] == Approx(0.001));
  scan.options.near.clear();
  scan.options.within = 0;
  scan.add_text("fine.xyz", fine);
  scan.options.scale = 0.25;
  CHECK(scan.steps() == std::array{0.25, 0.25, 0.25});
  // Every hundredth point may have kept its digits.
  auto mixed = coarse;
  for (std::size_t i = 0; i < mixed.size(); i += 120) mixed[i].y += 0.003;
  scan.options.scale.reset();
  scan.add_las("mixed.las", mixed);
  CHECK(scan.steps()[1] == Approx(0.5));
}

TEST_CASE("steps are those that a scan has before its pose turns it") {
  SteppedScan scan;
  scan.add_ptx("a.ptx",
               street(20'000, {30, 50, 3},
                      [](const Vec3& p) {
                        return Vec3{p.x, to(p.y, 0.5, 0.37), p.z};
                      }),
               0.6);
  CHECK(scan.steps()[0] == Approx(0.5).epsilon(1e-3));
  check_equal(number(only(scan.warnings, "lost-digits"), "raster"), 0);
  scan.add_ptx("b.ptx", terrain(1, 0, {30, 50, 3}), 0.6);
  for (const double step : scan.steps()) CHECK(step <= 0.001);
  check_equal(number(only(scan.warnings, "lost-digits"), "raster"), 1);
}

TEST_CASE("regular rasters have steps and did not lose them") {
  const Vec3 at{300, 500, 3};
  const auto fine = street(60'000, at, [](const Vec3& p) { return p; });
  const std::vector<Vec3> points =
      GENERATE_COPY(terrain(1, 0, at), terrain(0.5, 0, at + Vec3{0.37, 0.1, 0}),
                    terrain(1, std::acos(0.5), at), terrain(2, std::atan(1), at),
                    terrain(1, std::atan(0.75), at), voxels(fine, 0.5), voxels(fine, 0.25));
  SteppedScan scan;
  const bool as_text = GENERATE(false, true);
  if (as_text) {
    scan.add_text("a.xyz", points);
  } else {
    scan.add_las("a.las", points);
  }
  for (const double step : scan.steps()) CHECK(step <= 0.01);
  for (const Message& warning : scan.warnings) {
    check_equal(warning.code, "lost-digits");
    check_equal(number(warning, "raster"), 1);
  }
}

TEST_CASE("points that were rounded are no raster, however few there are to a step") {
  const std::size_t points = GENERATE(1500, 6000, 60'000);
  SteppedScan scan;
  scan.add_las("a.las", street(points, {300, 500, 3}, [](const Vec3& p) {
                 return Vec3{to(p.x, 0.25), to(p.y, 0.25), to(p.z, 0.25)};
               }));
  const std::array<double, 3> found = scan.steps();
  CHECK(found[0] == Approx(0.25));
  CHECK(found[1] == Approx(0.25));
}

TEST_CASE("coordinates that are cut off are counted, and a single greatest one is not") {
  const Folder folder;
  std::vector<Quantum> points = scan(2000, 1, 2'147'000'000, 2'147'483'646);
  const auto cut = [&](std::size_t count, double step) {
    std::vector<Quantum> ends = points;
    for (std::size_t i = 0; i < count; ++i) ends[3 * i][1] = 2'147'483'647;
    Quantisation quantisation = kMillimetres;
    quantisation.scale[1] = step;
    return folder.warnings({folder.add("a.las", ends, quantisation)});
  };
  CHECK(cut(1, 0.001).empty());
  const Message some = only(cut(40, 0.001), "cut-off");
  check_says(some.text, "a.las: has 40 points at the greatest y");
  check_equal(number(some, "y"), 40);
  check_equal(number(some, "x"), 0);
  // A scale that was computed from the points has their outermost ones at the ends.
  CHECK(cut(40, 0.00101234567891).empty());
}

TEST_CASE("coordinates that lost their digits are warned of with their step") {
  const Folder folder;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> metres(0, 90);
  const auto text = [&](double east, double north, const std::function<double(double)>& lose) {
    std::string lines;
    for (int i = 0; i < 1500; ++i) {
      lines += format_number(lose(east + metres(random))) + " " +
               format_number(lose(north + metres(random))) + " " +
               format_number(metres(random) / 30) + "\n";
    }
    put_bytes(folder.folder / "a.xyz", lines);
    return folder.warnings({folder.folder / "a.xyz"});
  };
  const auto to = [](double step) {
    return [step](double v) { return std::round(v / step) * step; };
  };
  const Message whole = only(text(500'000, 5.4e6, to(1)), "lost-digits");
  check_says(whole.text, "coordinates x, y come in steps of 1 m, 1 m");
  check_equal(number(only(text(500'000, 5.4e6, to(10)), "lost-digits"), "step"), 10);
  const auto single = [](double v) { return static_cast<double>(static_cast<float>(v)); };
  const Message floats = only(text(500'000, 5.4e6, single), "lost-digits");
  check_says(floats.text, "x, y come in steps of 0.03125 m, 0.5 m");
  CHECK(text(500'000, 5.4e6, to(0.01)).empty());
  CHECK(text(0, 0, single).empty());
  // A flat scan loses nothing along its height.
  put_bytes(folder.folder / "flat.xyz", [&] {
    std::string lines;
    for (int i = 0; i < 1500; ++i) {
      lines += format_number(metres(random)) + " " + format_number(metres(random)) + " 0\n";
    }
    return lines;
  }());
  CHECK(folder.warnings({folder.folder / "flat.xyz"}).empty());
}
