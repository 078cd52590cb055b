// Tables whose columns are not named: those that look like something other than points are refused
// with what they look like, and the usual layouts of scans are not. Rows with names, and columns
// that the caller chooses, are in tests/formats/text.case.
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <regex>
#include <sstream>

#include "clearway/model.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

template <typename... Numbers>
std::string print(const char* format, Numbers... numbers) {
  char text[512];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

/// Makes lines whose columns are named: "i u 0.5" has the line's number, a random number and 0.5.
class Table {
 public:
  std::string text(const std::string& words, int lines) {
    std::string out;
    for (i_ = 0; i_ < lines; ++i_) out += line(words) + "\n";
    return out;
  }

 private:
  std::string line(const std::string& words) {
    std::string out;
    for (std::size_t at = 0; at < words.size();) {
      const std::size_t end = std::min(words.find_first_of(" ,", at), words.size());
      const std::string word = words.substr(at, end - at);
      const auto column = columns_.find(word);
      out += column == columns_.end() ? progression(word) : column->second();
      if (end < words.size()) out += words[end];
      at = end + 1;
    }
    return out;
  }
  /// A+Bi@D is A + B i with D decimals, where A and D may be absent, and i may be i/N or i%N; any
  /// other word is itself.
  std::string progression(const std::string& word) const {
    static const std::regex kForm(R"((?:([-.e\d]+)\+)?([-.e\d]*)i(?:([/%])(\d+))?(?:@(\d))?)");
    std::smatch parts;
    if (!std::regex_match(word, parts, kForm)) return word;
    const auto number = [&](int part, double otherwise) {
      return parts.length(part) > 0 ? std::stod(parts[part]) : otherwise;
    };
    const int n = static_cast<int>(number(4, 1));
    const int step = parts[3] == "%" ? i_ % n : i_ / n;
    const double value = number(1, 0) + number(2, 1) * step;
    return parts.length(5) > 0 ? print("%.*f", static_cast<int>(number(5, 0)), value)
                               : print("%g", value);
  }
  double share() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  std::string unit_vector() {
    std::normal_distribution<double> normal;
    const double x = normal(random_), y = normal(random_), z = normal(random_);
    const double length = std::sqrt(x * x + y * y + z * z);
    return print("%.6f %.6f %.6f", x / length, y / length, z / length);
  }
  std::string matrix() {
    const double c = std::cos(0.01 * i_), s = std::sin(0.01 * i_);
    return print("%.9f %.9f 0 %g %.9f %.9f 0 %g 0 0 1 0.3", c, -s, 0.5 * i_, s, c, 0.1 * i_);
  }

  int i_ = 0;
  std::mt19937 random_{11};
  const std::map<std::string, std::function<std::string()>> columns_{
      {"5i%7", [&] { return print("%d", 5 * i_ % 7); }},
      {"1000+7i+i%3", [&] { return print("%d", 1000 + 7 * i_ + i_ % 3); }},
      {"0.05i+0.03u", [&] { return print("%.3f", 0.05 * i_ + 0.03 * share()); }},
      {"u", [&] { return print("%.3f", share()); }},
      {"9u", [&] { return print("%.3f", 9 * share()); }},
      {"-9u", [&] { return print("%.1f", -9 * share()); }},
      {"cm", [&] { return print("%.2f", share()); }},
      {"m", [&] { return print("%.3f", (i_ % 2 == 0 ? 30 : -30) * share()); }},
      {"colour", [&] { return print("%d", static_cast<int>(256 * share())); }},
      {"normal", [&] { return unit_vector(); }},
      {"sin", [&] { return print("%.4f", std::sin(0.3 * i_)); }},
      {"cos", [&] { return print("%.4f", std::cos(0.3 * i_)); }},
      {"wave", [&] { return print("%.3f", std::sin(0.1 * i_)); }},
      {"north", [&] { return print("%.2f", 5.4e6 + share()); }},
      {"matrix", [&] { return matrix(); }},
      {"qz", [&] { return print("%.6f", std::sin(0.01 * i_)); }},
      {"qw", [&] { return print("%.6f", std::cos(0.01 * i_)); }},
      {"half_qz", [&] { return print("%.6f", std::sin(0.1 * i_) * std::sqrt(0.75)); }},
      {"half_qw", [&] { return print("%.6f", std::cos(0.1 * i_) * std::sqrt(0.75)); }},
      {"steps", [&] { return print("%.3f", 12.0 + 0.01 * i_ * i_); }},
      {"beam",  // one that turns
       [&] {
         return print("%.3f %.3f %.3f", 5 * std::cos(0.07 * i_), 5 * std::sin(0.07 * i_),
                      0.3 + 0.01 * i_);
       }},
      {"far", [&] {
         return print("%.3f %.3f %.3f", 5e5 + 0.7 * i_ * i_, 5.4e6 - 0.3 * i_ * i_,
                      101.0 + 0.1 * i_);
       }}};
};

ReadCloud cloud_of(const std::string& text, const std::vector<std::string>& columns = {}) {
  const ScratchFolder scratch;
  return read_all(*open_point_file(scratch.write("a.csv", text), {columns, true}));
}

struct Row {
  const char* columns;
  const char* looks_like;
  double first_column;  ///< of the coordinates, where the message knows it
  std::vector<int> lines;
};

const Row kOthers[] = {
    {"matrix", "12 numbers", 2, {1, 2, 50, 300}},
    {"matrix 0 0 0 1", "16 numbers", 2, {1, 2, 50, 300}},
    {"7i matrix", "13 numbers", 2, {1, 2, 50, 300}},
    {"matrix 0 0 0 1 2", "17 numbers", 2, {1, 2, 50, 300}},
    {"1700000.5+0.1i@3 0.5i 0.1i@3 0.3 0 0 qz qw", "quaternion", 2, {2, 50, 300}},
    {"0.5i 0.1i@2 2 0.3 0.4 half_qz half_qw", "7 numbers", 1, {9}},
    {"i 5.2+0.3i@3 8.100 2.700", "number", 2, {3, 50, 300}},
    {"1+i 5.2+0.3i@3 8.100 2.700", "number", 2, {3, 50, 300}},
    {"1001+i,5.2+-0.1i@3,8.100,2.700,wall", "number", 2, {3, 50, 300}},
    {"1623423423.25+0.1i@6 0.5i 8.1 2.7", "time", 2, {20}},
    {"388721.25+1e-5i@6 beam", "time", 2, {12, 100, 250}},
    {"388721.25+1e-3i/2@6 beam", "time", 2, {12, 100, 250}},  // a beam with two returns
    {"0.1i@3 beam 7", "time", 2, {12, 100, 250}},
    {"0.1i@2 beam 7 8 9", "time", 2, {12, 100, 250}},
    {"1000+50i beam", "time", 2, {12, 100, 250}},
    {"1000+7i+i%3 beam", "time", 2, {12, 100, 250}},
    // With as many digits as the coordinates and steps that differ, a map tells.
    {"steps far", "time", 2, {12, 100, 250}},
    {"i/7 i%7 beam", "row", 3, {12, 100, 250}},
    {"i%7 i/7 beam 0.5", "row", 3, {12, 100, 250}},
    {"0 3i beam 9 8 7", "row", 3, {12, 100, 250}},
    {"1+i/5 1+2i%5 far", "row", 3, {12, 100, 250}}};

/// Layouts of points that are sorted or lie in a grid, which few lines do not tell.
constexpr const char* kSorted =
    "0.05i@3 5.250 u u; 0.05i@3 0.02i@3 u 0.5; 0.05i@3 u u 17; 0.05i@3 u u -9u; "
    "0.05i+0.03u 9u u u; 0.05i@3 u u i%255 7 9; 0.05i@3 wave 1.0i@3 cos sin 0.000; "
    "5e5+0.05i@2 north cm 388721.25+1e-5i@6; 0.5i u u; i/7 i%7 i%3 i%5; i/7 i%7 cm 1 2 3; "
    "i/7 i%7 cm cm; i/7 i%7 cm cos sin 0.0000; i/7 5i%7 cm cm cm";

/// Layouts of scans: intensities, colours, normals with a curvature, and regular grids.
constexpr const char* kScans =
    "m m m; m m m 0.5; m m m colour colour colour; m m m -1200 colour colour colour; "
    "m m m normal; m m m normal 0; m m m 0 normal; m m m 0 normal 0; m m m 0 normal 0.01; "
    "m m m colour colour colour normal; m m m 0 0 0 normal; "
    "m m m 12 colour colour colour normal 0.01 3; m m m m m m normal normal; "
    "0 0 0 normal 0; i 0 0 9; i i 0.5 9; 1.0i@3 0.000 1.25 9; 512345.5+i 4.1 101.25; "
    "i 0.1i@2 5.50; i/2 0.1i@2 5.50 1 2 3; 512345.5+0.1i@3 5412345.250 12.1 i%3 1 3e8+i@4; "
    "1 0 0 0 0 1 0 0 0 0 0.9 0";

void check_refused_as(const Row& row, const std::string& text) {
  try {
    cloud_of(text);
    FAIL("read as points");
  } catch (const InputError& error) {
    check_says(error.what(), std::string("line ... looks like ... ") + row.looks_like);
    CHECK(error.remedy() == Remedy::kColumns);
    CHECK(error.amount() == row.first_column);
  }
  const ScratchFolder scratch;
  try {
    read_model_points(scratch.write("model.txt", text));
    FAIL("read as a model");
  } catch (const InputError& error) {
    check_says(error.what(), std::string("looks like ... ") + row.looks_like);
    CHECK(error.remedy() == Remedy::kNone);  // a model's columns cannot be chosen
  }
}

}  // namespace

TEST_CASE("poses, times, numbers and grid indices before the coordinates are refused as these") {
  Table table;
  for (const Row& row : kOthers) {
    for (const int lines : row.lines) {
      const std::string text = table.text(row.columns, lines);
      INFO(row.columns << ", " << lines << " lines");
      check_refused_as(row, text);
      check_refused_as(row, "# ground truth\n" + text);
      const auto x = static_cast<int>(row.first_column);
      if (x == 0) continue;
      const auto chosen = cloud_of(text, {print("%d", x), print("%d", x + 1), print("%d", x + 2)});
      CHECK(chosen.size() == static_cast<std::size_t>(lines));
    }
  }
  std::string quoted;
  for (int i = 0; i < 20; ++i) quoted += print("\"%d\",\"%d.5\",\"2.5\",\"3.5\"\n", i, i % 3);
  check_refused([&] { cloud_of(quoted); }, "looks like");
}

TEST_CASE("scans of every usual layout, sorted or in a grid, are points") {
  const auto check = [](const char* layouts, std::initializer_list<int> counts) {
    std::istringstream in(layouts);
    for (std::string columns; std::getline(in >> std::ws, columns, ';');) {
      Table table;
      for (const int lines : counts) {
        INFO(columns << ", " << lines << " lines");
        CHECK_NOTHROW(cloud_of(table.text(columns, lines)));
      }
    }
  };
  check(kSorted, {12, 100, 250});
  check(kScans, {1, 2, 3, 10, 100, 250});
}

TEST_CASE("three columns have to be chosen") {
  CHECK_THROWS_AS(cloud_of("1 2 3\n", {"1", "2"}), UsageError);
}
