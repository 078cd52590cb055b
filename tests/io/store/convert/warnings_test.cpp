// Conversions warn where something is wrong with the inputs, and only there.
#include <cmath>
#include <fstream>
#include <functional>
#include <random>

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
  check_says(whole.text, "coordinates x, y are multiples of 1 m, 1 m");
  check_equal(number(only(text(500'000, 5.4e6, to(10)), "lost-digits"), "step"), 10);
  const auto single = [](double v) { return static_cast<double>(static_cast<float>(v)); };
  const Message floats = only(text(500'000, 5.4e6, single), "lost-digits");
  check_says(floats.text, "x, y are multiples of 0.03125 m, 0.5 m");
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
