// Conversions warn where something is wrong with the inputs, and only there.
#include <cmath>
#include <random>
#include <set>

#include "core/util/format.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/memory_cloud.hpp"
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

/// A scan of which some points are at one place.
std::vector<Quantum> crowded_scan(std::size_t points, std::size_t first, std::size_t crowded) {
  std::vector<Quantum> out = scan(points, 8);
  for (std::size_t i = 0; i < crowded; ++i) out[first + i] = {1234, 5678, 90};
  return out;
}

Quantisation millimetres_at(double x) { return {{0.001, 0.001, 0.001}, {x, 0, 0}}; }

/// The only warning of a conversion, which has to have this code.
Message only(const std::vector<Message>& warnings, const std::string& code) {
  REQUIRE(codes_of(warnings) == code);
  return warnings[0];
}

std::string text_of(const std::vector<Vec3>& points, const std::string& end_of_line = "\n") {
  std::string lines;
  for (const Vec3& p : points) {
    lines += format_number(p.x) + " " + format_number(p.y) + " " + format_number(p.z) + end_of_line;
  }
  return lines;
}

/// A warning's text, and its numbers behind it: "... points=7 share=0.5".
std::string said_by(const Message& warning) {
  std::string text = warning.text;
  for (const auto& [key, value] : warning.numbers) text += " " + key + "=" + format_number(value);
  return text;
}

}  // namespace

TEST_CASE("ordinary scans convert without a warning, strictly too") {
  Conversion conversion;
  conversion.add_las("a.las", scan(20'000, 1));
  conversion.add_las("b.las", scan(300, 2, 40'000, 90'000));
  conversion.add_las("c.las", scan(5, 3), {{0.001, 0.001, 0.001}, {900, -200, 0}});
  conversion.options.strict = true;
  const ConversionReport report = conversion.convert();
  check_equal(codes_of(report.warnings), "");
  check_equal(report.points, 20'305);
  CHECK(report.scale == Vec3{0.001, 0.001, 0.001});
  CHECK(report.offset == Vec3{100, -200, 0});
  CHECK(report.box.value().lo.x >= 100);
  CHECK(report.box->hi.x > 900);
}

TEST_CASE("many points at one place are counted exactly, wherever they stand") {
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
  Conversion conversion;
  conversion.add_las("a.las", scan(1000, 6, 1, 50'000));
  conversion.add_las("b.las", points);
  const Message warning = only(conversion.convert().warnings, "same-place");
  check_equal(number_of(warning, "points"), static_cast<double>(zeros));
  check_equal(number_of(warning, "share"),
              static_cast<double>(zeros) / static_cast<double>(many + 1000));
  check_equal(number_of(warning, "x"), 100);
  check_says(warning.text, "100 -200 0 ... point " + format_count(first) +
                               " ( ... b.las to point " + format_count(last) +
                               " ( ... b.las ... zeros in the file");
}

TEST_CASE("what is wrong with the points of scans causes one warning, and what is ordinary none") {
  struct Scan {
    std::string name;
    std::vector<Quantum> points;
    Quantisation quantisation = kMillimetres;
  };
  // words: of the warning; none: there is none.
  const auto check = [](const std::vector<Scan>& scans, const char* code, const char* words,
                        const char* lacks = "no words") {
    const RowName name(scans[0].name);
    Conversion conversion;
    for (const Scan& scan : scans) conversion.add_las(scan.name, scan.points, scan.quantisation);
    const std::vector<Message> warnings = conversion.convert().warnings;
    check_equal(codes_of(warnings), code);
    check_says(warnings.empty() ? "" : said_by(warnings[0]), words);
    check_lacks(warnings.empty() ? "" : warnings[0].text, lacks);
  };
  check({{"nine of 40 points.las", crowded_scan(40, 0, 9)}}, "", "");
  check({{"ten of 40 points.las", crowded_scan(40, 0, 10)}}, "same-place", "10 of 40 points");
  check({{"less than a hundredth.las", crowded_scan(200'000, 0, 1990)}}, "", "");
  check({{"not at the origin.las", crowded_scan(50'000, 100, 1000)}}, "same-place",
        "101.234 -194.322 0.09, from point 100 (counted from 0) of ... to point 1,099 ( ... "
        "points=1000 share=0.02 ... places=1",
        "half");
  std::vector<Scan> tiles, frames;
  for (unsigned i = 0; i < 60; ++i) {
    tiles.push_back(
        {std::to_string(100 + i) + ".las", scan(50, 40 + i, 0, 10'000), millimetres_at(500.0 * i)});
    if (i < 4) frames.push_back({tiles[i].name, scan(100, i), millimetres_at(500'000 + 40.0 * i)});
  }
  frames.insert(frames.begin() + 2, {"local.las", scan(100, 30), millimetres_at(0)});
  check(frames, "far-apart", "local.las lies ... frame ... gap=49995 ... files=1");
  check(tiles, "", "");
  std::vector<Quantum> large = scan(100, 50);
  for (Quantum& q : large) q = {1000 * q[0], 1000 * q[1], 1000 * q[2]};
  check({{"a.las", scan(100, 50), millimetres_at(0)},
         {"mm.las", large, millimetres_at(0)},
         {"c.las", scan(100, 51), millimetres_at(0)}},
        "other-size", "mm.las ... millimetres ... ratio=996");
  check({{"some.las", scan(100, 60)}, {"none.las", {}}}, "no-points", "none.las", "collide");
  check({{"none.las", {}}}, "no-points", "nothing can collide");
}

TEST_CASE("zeros and points that are not finite in floating-point files cause a warning") {
  Conversion conversion;
  std::vector<Vec3> points(4000);
  for (int i = 0; i < 2000; ++i) points[static_cast<std::size_t>(i)] = {0.001 * i + 3, 4, 5};
  conversion.add_ply("a.ply", points);
  check_says(only(conversion.convert().warnings, "same-place").text, "50 % ... zeros in the file");
  conversion.add_ply("a.ply", std::vector<Vec3>{{1, 2, 3}, {1, 2, 4}});
  conversion.add_ply("b.ply", std::vector<Vec3>{{1, 2, 5}, {std::nan(""), 0, 0}});
  check_says(said_by(only(conversion.convert().warnings, "non-finite-points")),
             "25 % ... point 1 ... b.ply ... share=0.25");
}

TEST_CASE("a scan that is given twice causes a warning, by whatever names") {
  Conversion conversion;
  conversion.add_las("a.las", scan(500, 10));
  conversion.add_las("b.las", scan(500, 11));
  CHECK(conversion.convert().warnings.empty());
  const fs::path a = conversion.folder / "a.las", other = conversion.folder / "other.las";
  std::string words = "other.las is the same file as ... files=1";
  SECTION("the same name") { words = "same file ... 500 points ... files=1"; }
  SECTION("a link") { fs::create_symlink(a, other); }
  SECTION("a hard link") { fs::create_hard_link(a, other); }
  SECTION("a copy") {
    fs::copy_file(a, other);
    words = "other.las has the same bytes as ... files=1";
  }
  conversion.options.inputs.push_back(fs::exists(other) ? other : a);
  check_says(said_by(only(conversion.convert().warnings, "same-scan")), words);
}

TEST_CASE("warnings do not depend on threads") {
  Conversion conversion;
  std::vector<Quantum> points = scan(400'000, 9);
  for (std::size_t i = 0; i < points.size(); i += 17) points[i] = {7, 7, 7};
  conversion.add_las("a.las", points);
  conversion.options.inputs.push_back(conversion.options.inputs[0]);
  std::set<std::string> texts;
  for (const int threads : {1, 2, 5}) {
    conversion.options.threads = threads;
    std::string text;
    for (const Message& warning : conversion.convert().warnings) text += warning.text + "|";
    texts.insert(text);
  }
  check_equal(texts.size(), 1);
  check_says(*texts.begin(), "same file ... one place");
}

TEST_CASE("a strict conversion tells all warnings and leaves nothing behind") {
  Conversion conversion;
  conversion.add_las("a.las", std::vector<Quantum>(3000));
  ConversionOptions& options = conversion.options;
  options.inputs.push_back(options.inputs[0]);
  options.strict = true;
  std::vector<Message> told;
  options.message = [&told](const Message& message) {
    if (message.severity == Message::Severity::kWarning) told.push_back(message);
  };
  check_equal(conversion.refusal(),
              "strict: 2 warnings (same-scan, same-place), expected none; no output was written");
  check_equal(codes_of(told), "same-scan, same-place");
  CHECK_FALSE(fs::exists(options.output));
  CHECK_FALSE(fs::exists(conversion.folder / "a.h5.partial"));
}

namespace {

/// What an axis of a scan is rounded to.
struct Rounding {
  double step = 0;  ///< 0: nothing; below 0: single precision
  double offset = 0;

  double operator()(double value) const {
    if (step < 0) return static_cast<float>(value);
    return step == 0 ? value : std::round((value - offset) / step) * step + offset;
  }
};
using Roundings = std::array<Rounding, 3>;
constexpr Rounding kSingle{-1};

/// A road of 40 x 8 m with a fence on either side, as a scanner sees them.
std::vector<Vec3> street(std::size_t points, const Vec3& at, const Roundings& round = {}) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < points; ++i) {
    const double x = 40 * share(random), y = 8 * share(random), z = 0.05 * share(random);
    const bool fence = i % 3 == 0;
    const Vec3 p = at + Vec3{x, fence ? (y < 4 ? 0.2 : 7.8) + z : y, fence ? y / 3 : z};
    out.push_back({round[0](p.x), round[1](p.y), round[2](p.z)});
  }
  return out;
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
  std::set<std::array<double, 3>> places;
  for (const Vec3& p : points) {
    places.insert({std::round(p.x / step), std::round(p.y / step), std::round(p.z / step)});
  }
  std::vector<Vec3> out;
  for (const auto& [x, y, z] : places) out.push_back({step * x, step * y, step * z});
  return out;
}

struct SteppedScan : Conversion {
  void add(const std::string& name, const std::vector<Vec3>& points) {
    if (name.ends_with(".las")) {
      add_las(name, quantise(points, kMillimetres));
    } else {
      Conversion::add(name, text_of(points));
    }
  }
  /// Adds points that the pose of their scan turns about z.
  void add_ptx(const std::string& name, const std::vector<Vec3>& points, double turn) {
    const std::string c = format_number(std::cos(turn)), s = format_number(std::sin(turn));
    const std::string x = c + " " + s + " 0", y = "-" + s + " " + c + " 0";
    std::string text = std::to_string(points.size()) + "\n1\n7 8 9\n" + x + "\n" + y + "\n0 0 1\n" +
                       x + " 0\n" + y + " 0\n0 0 1 0\n7 8 9 1\n" + text_of(points, " 0.5\n");
    Conversion::add(name, text);
  }
  /// The steps that the store has.
  std::array<double, 3> steps() {
    warnings = convert().warnings;
    const StoreReader store(options.output);
    options.inputs.clear();
    return store.metadata().steps;
  }

  std::vector<Message> warnings;
};

}  // namespace

TEST_CASE("a store has the steps to which coordinates were rounded, whatever the offset") {
  const Roundings round = GENERATE(values<Roundings>({{{{}, {0.5}, {}}},
                                                      {{{}, {0.5, 0.37}, {}}},
                                                      {{{0.3048}, {0.3048}, {}}},
                                                      {{{0.5}, {0.25, 0.1}, {0.07}}},
                                                      {{kSingle, {0.1}, kSingle}}}));
  const std::string file = GENERATE("a.xyz", "a.las");
  SteppedScan scan;
  scan.add(file, street(20'000, {300, 500, 3}, round));
  CAPTURE(file, round[0].step, round[1].step, round[2].step);
  const std::array<double, 3> found = scan.steps();
  for (std::size_t k = 0; k < 3; ++k) {
    if (round[k].step > 0) check_near(found[k], round[k].step, 1e-3 * round[k].step);
    if (round[k].step <= 0) CHECK((found[k] > 0 && found[k] <= 0.001));
  }
  check_equal(number_of(only(scan.warnings, "lost-digits"), "raster"), 0);
}

TEST_CASE("steps are those of the coarsest input, of the kept points and of the store") {
  const Vec3 at{300, 500, 3};
  const auto fine = street(9000, at);
  const auto coarse = street(9000, at + Vec3{0, 20, 0}, {{{}, {0.5}, {}}});
  SteppedScan scan;
  scan.add("fine.las", fine);
  scan.add("coarse.las", coarse);
  CHECK(scan.steps()[1] == Approx(0.5));
  scan.add("fine.las", fine);
  scan.add("coarse.las", coarse);
  scan.options.near = scan.folder.write("p.txt", "1 0 0 310 0 1 0 505 0 0 1 3 0 0 0 1\n");
  scan.options.within = 5;
  CHECK(scan.steps()[1] == Approx(0.001));
  scan.options.near.clear();
  scan.options.within = 0;
  scan.add("fine.xyz", fine);
  scan.options.scale = 0.25;
  CHECK(scan.steps() == std::array{0.25, 0.25, 0.25});
  // Every hundredth point may have kept its digits.
  auto mixed = coarse;
  for (std::size_t i = 0; i < mixed.size(); i += 120) mixed[i].y += 0.003;
  scan.options.scale.reset();
  scan.add("mixed.las", mixed);
  CHECK(scan.steps()[1] == Approx(0.5));
}

TEST_CASE("steps are those that a scan has before its pose turns it") {
  SteppedScan scan;
  scan.add_ptx("a.ptx", street(20'000, {30, 50, 3}, {{{}, {0.5, 0.37}, {}}}), 0.6);
  CHECK(scan.steps()[0] == Approx(0.5).epsilon(1e-3));
  check_equal(number_of(only(scan.warnings, "lost-digits"), "raster"), 0);
  scan.add_ptx("b.ptx", terrain(1, 0, {30, 50, 3}), 0.6);
  for (const double step : scan.steps()) CHECK(step <= 0.001);
  check_equal(number_of(only(scan.warnings, "lost-digits"), "raster"), 1);
}

TEST_CASE("regular rasters have steps and did not lose them") {
  const Vec3 at{300, 500, 3};
  const std::vector<Vec3> points = GENERATE_COPY(
      terrain(1, 0, at), terrain(0.5, 0, at + Vec3{0.37, 0.1, 0}), terrain(1, std::acos(0.5), at),
      terrain(2, std::atan(1), at), terrain(1, std::atan(0.75), at),
      voxels(street(60'000, at), 0.5), voxels(street(60'000, at), 0.25));
  SteppedScan scan;
  scan.add(GENERATE("a.xyz", "a.las"), points);
  for (const double step : scan.steps()) CHECK(step <= 0.01);
  if (!scan.warnings.empty()) {
    check_equal(number_of(only(scan.warnings, "lost-digits"), "raster"), 1);
  }
}

TEST_CASE("points that were rounded are no raster, however few there are to a step") {
  SteppedScan scan;
  scan.add("a.las",
           street(GENERATE(1500, 6000, 60'000), {300, 500, 3}, {{{0.25}, {0.25}, {0.25}}}));
  const std::array<double, 3> found = scan.steps();
  CHECK(found[0] == Approx(0.25));
  CHECK(found[1] == Approx(0.25));
}

TEST_CASE("coordinates that are cut off are counted, and a single greatest one is not") {
  const auto cut = [&](std::size_t count, double step) {
    std::vector<Quantum> ends = scan(2000, 1, 2'147'000'000, 2'147'483'646);
    for (std::size_t i = 0; i < count; ++i) ends[3 * i][1] = 2'147'483'647;
    Conversion conversion;
    conversion.add_las("a.las", ends, {{0.001, step, 0.001}, {100, -200, 0}});
    return conversion.convert().warnings;
  };
  CHECK(cut(1, 0.001).empty());
  const Message some = only(cut(40, 0.001), "cut-off");
  check_says(some.text, "a.las: has 40 points at the greatest y");
  check_equal(number_of(some, "y"), 40);
  check_equal(number_of(some, "x"), 0);
  // A scale that was computed from the points has their outermost ones at the ends.
  CHECK(cut(40, 0.00101234567891).empty());
}

TEST_CASE("coordinates that lost their digits are warned of with their step") {
  // words: of the warning; none: there is none.
  const auto check = [](double east, double north, const Rounding& lose, const char* words) {
    CAPTURE(words);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> metres(0, 90);
    std::vector<Vec3> points(1500);
    for (Vec3& p : points) {
      p.x = lose(east + metres(random)), p.y = lose(north + metres(random));
      if (lose.step != 0) p.z = metres(random) / 30;  // a flat scan loses nothing along its height
    }
    SteppedScan scan;
    scan.add("a.xyz", points);
    scan.steps();
    check_says(scan.warnings.empty() ? "" : said_by(only(scan.warnings, "lost-digits")), words);
  };
  check(500'000, 5.4e6, {1}, "coordinates x, y come in steps of 1 m, 1 m ... step=1");
  check(500'000, 5.4e6, {10}, "x, y come in steps of 10 m, 10 m ... step=10");
  check(500'000, 5.4e6, kSingle, "x, y come in steps of 0.03125 m, 0.5 m");
  check(500'000, 5.4e6, {0.01}, "");
  check(0, 0, kSingle, "");
  check(0, 0, {}, "");
}
