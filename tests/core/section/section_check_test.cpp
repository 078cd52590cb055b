// What follows from the cells of a section: verdicts on outlines, free cells, widths.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

#include "clearway/error.hpp"
#include "clearway/section.hpp"
#include "core/section/section_lattice.hpp"
#include "core/section/section_tables.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A section with cells of 0.5, a window of 8 x 5 and bins of 5 along a path of 20 poses, 1 apart.
SectionData section_of(const std::vector<std::array<int, 4>>& cells) {
  SectionData data;
  data.parameters = {.rear = -1,
                     .front = 1,
                     .window = SectionWindow{-4, 4, 0, 5},
                     .cell = 0.5,
                     .bin = 5,
                     .margin = 1};
  data.rounding = 1e-9;
  data.environment_points = 1000;
  data.poses = data.load_poses = 20;
  for (int i = 0; i < 20; ++i) data.chainage.push_back(i);
  data.bins = {0, 1, 2, 3};
  for (const auto& [bin, j, k, pose] : cells) {
    data.bin_cells.bin.push_back(static_cast<std::uint32_t>(bin));
    data.bin_cells.j.push_back(j);
    data.bin_cells.k.push_back(k);
    data.bin_cells.first_pose.push_back(static_cast<std::uint32_t>(pose));
  }
  return data;
}

std::vector<OutlinePoint> box(double y_from, double y_to, double z_from, double z_to) {
  return {{y_from, z_from}, {y_to, z_from}, {y_to, z_to}, {y_from, z_to}};
}

}  // namespace

TEST_CASE("a load is stopped by the first cell that is closer than its margin") {
  // Cells from y = 2 to 2.5, z = 1 to 1.5, and from y = -3 to -2.5, z = 3 to 3.5.
  const Section section(section_of({{0, 4, 2, 3}, {1, -6, 6, 7}, {2, -6, 6, 11}, {2, 4, 2, 12}}));
  check_equal(section.cells().size(), 2);
  const SectionCheck check = section.check(box(-3, 1.95, 0.1, 3), 0.2);
  REQUIRE(check.stop);
  check_equal(check.stop->first_pose, 3);
  check_equal(check.stop->chainage, 3);
  CHECK(check.stop->cell == std::array<std::int32_t, 2>{4, 2});
  REQUIRE(check.stops.size() == 3);
  check_equal(check.stops[1].first_pose, 7);
  CHECK(check.stops[1].cell == std::array<std::int32_t, 2>{-6, 6});
  check_equal(check.stops[2].bin, 2);
  check_equal(check.stops[2].first_pose, 11);
  // Of the cells of a pose the lowest counts, and then the rightmost.
  const Section several(section_of({{0, 5, 2, 3}, {0, 0, 3, 2}, {0, 2, 3, 2}, {0, -3, 4, 2}}));
  const SectionCheck first = several.check(box(-2, 3, 0.6, 3), 0);
  REQUIRE(first.stop);
  check_equal(first.stop->first_pose, 2);
  CHECK(first.stop->cell == std::array<std::int32_t, 2>{0, 3});
}

TEST_CASE("a load passes, is stopped, or is unknown where it leaves the window or the margin") {
  const Section one(section_of({{0, 4, 2, 3}})), corner(section_of({{0, 7, 9, 3}}));
  const Section middle(section_of({{0, 0, 4, 3}}));  // y = 0 to 0.5, z = 2 to 2.5
  SectionData moving_data = section_of({{0, 4, 2, 3}});
  moving_data.motion = {0.3, 0.2};  // is kept as a distance, too
  moving_data.parameters.between_poses = true;
  const Section moving(std::move(moving_data));
  const auto symmetric = [](double half) { return box(-half, half, 0.1, 3); };
  const std::vector<OutlinePoint> slant{{1, 1.5}, {1.5, 1.5}, {1.5, 2}};
  const std::vector<OutlinePoint> around{{-1, 1}, {2, 1}, {2, 4}, {1, 4}, {1, 1.6}, {-1, 1.6}};
  struct Row {
    const char* what;
    const Section& section;
    std::vector<OutlinePoint> outline;
    double margin;
    const char* verdict;
    const char* reason = "";
  };
  for (const Row& row :
       {Row{"beside", one, symmetric(1.9), 0, "passes"},
        Row{"just beside", one, symmetric(1.9), 0.1 - 1e-8, "passes"},
        Row{"at the margin", one, symmetric(1.9), 0.1, "stopped"},
        Row{"touching", one, symmetric(2), 0, "stopped"},
        Row{"far beyond", one, symmetric(3.5), 0, "stopped"},
        Row{"up to the window", corner, box(-4, 1, 0, 3), 0, "passes"},
        Row{"a margin beyond it", corner, box(-4, 1, 0, 3), 0.01, "unknown", "leaves the window"},
        Row{"below it", corner, box(-1, 1, -0.1, 3), 0, "unknown", "leaves the window"},
        Row{"the greatest margin", corner, box(-1, 1, 1, 3), 1, "passes"},
        Row{"more", corner, box(-1, 1, 1.5, 3), 1.01, "unknown", "margins up to 1 only"},
        // What is known to stop a load stops it, even where not all of the load is known.
        Row{"stopped outside", corner, box(-4, 5, 0, 6), 2, "stopped"},
        Row{"moving", moving, box(-1, 1.85, 0.5, 3), 0, "passes"},
        Row{"moving too near", moving, box(-1, 1.95, 0.5, 3), 0, "stopped"},
        Row{"moving out of it", moving, box(-1, 1, 0.05, 3), 0, "unknown"},
        Row{"around a cell", middle, box(-3, 3, 1, 4), 0, "stopped"},
        Row{"inside a cell", middle, box(0.1, 0.2, 2.1, 2.2), 0, "stopped"},
        Row{"across a cell", middle, box(-1, 1, 2.2, 2.3), 0, "stopped"},
        // Nearest to the corner (0.5, 2): sqrt(0.5) = 0.7071.
        Row{"a slant", middle, slant, 0.7, "passes"},
        Row{"a slant too near", middle, slant, 0.71, "stopped"},
        Row{"an angle", middle, around, 0.39, "passes"},
        Row{"an angle too near", middle, around, 0.41, "stopped"}}) {
    const RowName name(row.what);
    const SectionCheck check = row.section.check(row.outline, row.margin);
    check_equal(name_of(check.verdict), row.verdict);
    if (*row.reason != 0) check_says(check.reason, row.reason);
  }
  const auto refused = [&](const std::vector<OutlinePoint>& outline, double margin,
                           const char* words) {
    check_refused([&] { corner.check(outline, margin); }, words);
  };
  refused(box(-1, 1, 1, 3), -1, "expected 0 or more");
  refused({{0, 0}, {1, 1}}, 0, "corners");
  refused({{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 0, "cross or touch");
  // Without a margin, that of the section counts, which is 1.
  CHECK(corner.check(box(-1, 1, 1, 3)).verdict == SectionVerdict::kPasses);
  check_says(corner.check(box(-1, 1, 0.9, 3)).reason, "leaves the window");
  CHECK((corner.free_cells() == corner.free_cells(1)));
}

TEST_CASE("a section in doubt lets no load pass") {
  for (const char* code :
       {"no-points", "no-poses", "all-ignored", "out-of-reach", "coarse-digits", "store-cut-off"}) {
    SectionData data = section_of({});
    data.warnings.push_back({Message::Severity::kWarning, code, "text"});
    const Section section(std::move(data));
    const SectionCheck check = section.check(box(-1, 1, 1, 3), 0);
    CHECK(check.verdict == SectionVerdict::kUnknown);
    check_says(check.reason, code);
    for (const bool free : section.free_cells(0)) CHECK_FALSE(free);
  }
}

TEST_CASE("an outline in another unit, which is smaller than any load, does not pass") {
  SectionData data = section_of({});
  const Section metres(data);
  data.length_unit = "us-survey-foot";
  const Section feet(data);
  const auto small = box(-0.01, 0.01, 1, 1.02);
  CHECK(metres.check(box(-0.0013, 0.0013, 1, 1.004)).verdict == SectionVerdict::kUnknown);
  CHECK(metres.check(box(-0.1, 0.1, 1, 1.02)).verdict == SectionVerdict::kPasses);
  CHECK(metres.check(small).verdict == SectionVerdict::kPasses);
  check_says(feet.check(small).reason, "its unit is probably another one");
}

TEST_CASE("free cells are those of the definition") {
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    std::set<std::pair<int, int>> blocked;  // (k, j)
    for (std::uint64_t n = below(random, 12); n > 0; --n) {
      blocked.insert(
          {static_cast<int>(below(random, 10)), static_cast<int>(below(random, 16)) - 8});
    }
    std::vector<std::array<int, 4>> cells;
    for (const auto& [k, j] : blocked) cells.push_back({0, j, k, 1});
    const Section section(section_of(cells));
    const double margin =
        below(random, 3) == 0 ? 0.5 * static_cast<double>(below(random, 3)) : uniform(random, 0, 1);
    const double g = 0.5;
    const std::vector<bool> free = section.free_cells(margin);
    REQUIRE(free.size() == 160);
    for (int k = 0; k < 10; ++k) {
      for (int j = -8; j < 8; ++j) {
        bool expected = blocked.count({k, j}) == 0;
        for (const auto& [bk, bj] : blocked) {
          const double a = std::max(std::abs(bj - j) - 1, 0), b = std::max(std::abs(bk - k) - 1, 0);
          if ((a * a + b * b) * (g * g) < margin * margin) expected = false;
        }
        const int n = std::min({j + 8, 7 - j, k, 9 - k});
        if (!(n * g >= margin)) expected = false;
        CHECK(free[static_cast<std::size_t>(16 * k + j + 8)] == expected);
      }
    }
  }
}

TEST_CASE("widths need the middle and a band of some height") {
  SectionData data = section_of({});
  data.parameters.window = SectionWindow{0.5, 4, 0, 5};
  check_refused([&] { return section_bands(Section(data), {}); }, "lacks the middle");
  check_refused([&] { return section_bands(Section(section_of({})), {.band = -1}); }, "above 0");
}

TEST_CASE("the largest load stands above what blocks the middle, unless a base is given") {
  const Section section(section_of({{0, 0, 0, 0}, {1, -1, 1, 5}, {2, 3, 4, 10}}));
  check_refused([&] { return largest_outline(section, {.band = 0.5, .base = 0}); },
                "the middle is blocked");
  const auto outline = largest_outline(section, {.band = 0.5});
  CHECK(std::ranges::min(outline, {}, &OutlinePoint::z).z == Approx(1));
  CHECK(section.check(outline, 0).verdict == SectionVerdict::kPasses);
  check_equal(section_boxes(section, {.band = 0.5}).front().z_from, 1);
  check_equal(section_boxes(section, {.band = 0.5, .base = 0}).front().z_from, 0);
}

TEST_CASE("the largest outline passes, and no wider one does") {
  Random random(11);
  for (int i = 0; i < 100; ++i) {
    std::set<std::array<int, 3>> blocked;  // bin, k, j
    for (std::uint64_t n = below(random, 30); n > 0; --n) {
      blocked.insert({static_cast<int>(below(random, 4)), static_cast<int>(below(random, 10)),
                      static_cast<int>(below(random, 16)) - 8});
    }
    std::vector<std::array<int, 4>> cells;
    for (const auto& [bin, k, j] : blocked) cells.push_back({bin, j, k, 5 * bin});
    const Section section(section_of(cells));
    std::vector<OutlinePoint> outline;
    try {
      outline = largest_outline(section, {.band = 0.5, .base = 0});
    } catch (const UsageError& error) {
      check_says(error.what(), "the middle is blocked");
      continue;
    }
    CHECK(section.check(outline, 0).verdict == SectionVerdict::kPasses);
    for (const OutlinePoint& corner : outline) CHECK(std::abs(corner.y) < 4);
  }
}

namespace {

/// A table of rows of 20 m at the most, which end at multiples of 0.5 and leave gaps.
OutlineTable random_table(Random& random) {
  OutlineTable table{.path = "table.csv"};
  double at = 0.5 * (static_cast<double>(below(random, 6)) - 4);
  while (at < 22) {
    OutlineRow row{.line = table.rows.size() + 2, .file = "load.csv"};
    row.from = at;
    row.to = at + 0.5 * static_cast<double>(1 + below(random, 16));
    const double half = uniform(random, 0.5, 2.5);
    row.outline = box(-half, half, 1, uniform(random, 1.5, 3.9));
    if (below(random, 2) == 0) row.margin = uniform(random, 0, 0.9);
    at = row.to + (below(random, 3) == 0 ? 0.5 * static_cast<double>(below(random, 8)) : 0);
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// Whether a row holds a place of bin `number` of section_of(), whose path ends at 19.
/// A row that ends where the path ends holds that end, unless the next one does.
bool touches(const OutlineTable& table, const OutlineRow& row, std::uint32_t number) {
  for (double at = 5.0 * number; at < 5.0 * number + 5 && at <= 19; at += 0.25) {
    if (row.from <= at && at < row.to) return true;
  }
  return number == 3 && row.to == 19 &&
         std::ranges::none_of(table.rows, [](const OutlineRow& next) { return next.from == 19; });
}

bool is_covered(const OutlineTable& table, std::uint32_t number) {
  for (double at = 5.0 * number; at < 5.0 * number + 5 && at <= 19; at += 0.25) {
    const bool held = std::ranges::any_of(
        table.rows, [&](const OutlineRow& row) { return row.from <= at && at < row.to; });
    const bool at_end = at == 19 && std::ranges::any_of(table.rows, [](const OutlineRow& row) {
                          return row.to == 19;
                        });
    if (!held && !at_end) return false;
  }
  return true;
}

std::vector<std::uint32_t> bins_of(const std::vector<SectionStop>& stops) {
  std::vector<std::uint32_t> bins;
  for (const SectionStop& stop : stops) bins.push_back(stop.bin);
  return bins;
}

OutlineTable table_of(const std::vector<std::array<double, 2>>& stretches,
                      const std::vector<OutlinePoint>& outline) {
  OutlineTable table{.path = "table.csv"};
  for (const auto& [from, to] : stretches) {
    table.rows.push_back({.line = table.rows.size() + 2,
                          .from = from,
                          .to = to,
                          .file = "load.csv",
                          .outline = outline,
                          .margin = 0});
  }
  return table;
}

}  // namespace

TEST_CASE("a table of outlines is one check for each row, of the bins that it touches") {
  Random random(31);
  std::set<std::string> verdicts;
  for (int i = 0; i < 300; ++i) {
    std::vector<std::array<int, 4>> cells;
    for (int bin = 0; bin < 4; ++bin) {
      if (below(random, 2) == 0) continue;
      const int j = static_cast<int>(below(random, 16)) - 8;
      cells.push_back({bin, j, static_cast<int>(below(random, 10)),
                       5 * bin + static_cast<int>(below(random, 5))});
    }
    const Section section(section_of(cells));
    const OutlineTable table = random_table(random);
    const OutlineTableCheck check = section.check(table, 0.25);
    SectionVerdict expected = SectionVerdict::kPasses;
    for (std::uint32_t bin = 0; bin < 4; ++bin) {
      const bool is_gap = std::ranges::any_of(
          check.gaps, [&](const OutlineGap& gap) { return gap.bins.contains(bin); });
      check_equal(is_gap, !is_covered(table, bin));
      if (is_gap) expected = SectionVerdict::kUnknown;
    }
    std::vector<std::uint32_t> all;
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
      const OutlineRow& row = table.rows[r];
      const OutlineRowCheck& judged = check.rows[r];
      const SectionCheck whole = section.check(row.outline, row.margin.value_or(0.25));
      std::vector<std::uint32_t> here;
      for (const SectionStop& stop : whole.stops) {
        if (touches(table, row, stop.bin)) here.push_back(stop.bin);
      }
      check_equal(bins_of(judged.check.stops), here);
      all.insert(all.end(), here.begin(), here.end());
      if (!judged.bins) continue;
      if (here.empty()) {
        CHECK(judged.check.reason ==
              (whole.verdict == SectionVerdict::kUnknown ? whole.reason : std::string()));
      }
      if (judged.check.verdict == SectionVerdict::kUnknown) expected = SectionVerdict::kUnknown;
    }
    std::ranges::sort(all);
    check_equal(bins_of(check.stops), all);
    if (!all.empty()) expected = SectionVerdict::kStopped;
    CHECK(check.verdict == expected);
    verdicts.insert(name_of(check.verdict));
  }
  check_equal(verdicts.size(), 3);
}

TEST_CASE("a bin that two rows cross is judged by both, and a gap makes it unknown") {
  // The cell is blocked in bin 1, from 5 to 10, and stops what is wider than 2.
  const Section section(section_of({{1, 4, 2, 7}}));
  OutlineTable table = table_of({{0, 9}, {9, 19}}, box(-1, 1, 0.5, 3));
  CHECK(section.check(table).verdict == SectionVerdict::kPasses);
  table.rows[1].outline = box(-1, 2.2, 0.5, 3);
  const OutlineTableCheck stopped = section.check(table);
  CHECK(stopped.verdict == SectionVerdict::kStopped);
  check_equal(stopped.stop->row, 1);
  check_equal(stopped.stop->first_pose, 7);
  CHECK(stopped.rows[0].check.verdict == SectionVerdict::kPasses);

  const auto bins_in_gaps = [&](const std::vector<std::array<double, 2>>& stretches) {
    std::string bins;
    const OutlineTableCheck check = section.check(table_of(stretches, box(-1, 1, 0.5, 3)));
    for (const OutlineGap& gap : check.gaps) {
      bins += std::to_string(gap.bins.first) + "-" + std::to_string(gap.bins.last) + " ";
    }
    return bins + name_of(check.verdict);
  };
  check_equal(bins_in_gaps({{0, 19}}), "passes");
  check_equal(bins_in_gaps({{-5, 30}}), "passes");
  check_equal(bins_in_gaps({{0.0004, 18.9996}}), "passes");
  check_equal(bins_in_gaps({{0, 7}, {7.5, 19}}), "1-1 unknown");
  check_equal(bins_in_gaps({{0, 10}, {15, 19}}), "2-2 unknown");
  check_equal(bins_in_gaps({{2, 18}}), "0-0 3-3 unknown");
  check_equal(bins_in_gaps({{30, 40}}), "0-3 unknown");
  CHECK_FALSE(section.check(table_of({{0, 19}, {30, 40}}, box(-1, 1, 0.5, 3))).rows[1].bins);
}

TEST_CASE("a table of which no row is judged is unknown") {
  SectionData data = section_of({});
  data.bins.clear();
  data.warnings.push_back({Message::Severity::kWarning, "no-poses", "text"});
  const OutlineTableCheck check =
      Section(std::move(data)).check(table_of({{0, 19}}, box(-1, 1, 0.5, 3)));
  CHECK(check.verdict == SectionVerdict::kUnknown);
  check_says(check.reason, "no pose on the path of any row");
}

TEST_CASE("a warned stretch leaves only rows unknown that touch it, or the way around it") {
  for (const bool ways : {false, true}) {
    SectionData data = section_of({});
    data.parameters.between_poses = ways;
    data.motion = {ways ? 1.0 : 0.0, 0};
    const PoseRange warned = ways ? PoseRange{10, 10} : PoseRange{11, 12};
    data.warnings.push_back({Message::Severity::kWarning, "nothing-below", "text", {}, {{warned}}});
    const OutlineTableCheck check =
        Section(std::move(data))
            .check(table_of({{0, 5}, {5, 10}, {10, 15}, {15, 19}}, box(-1, 1, 0.5, 3)));
    for (std::size_t row = 0; row < 4; ++row) {
      const bool is_warned = row == 2 || (row == 1 && ways);
      CHECK((check.rows[row].check.verdict == SectionVerdict::kPasses) == !is_warned);
      if (is_warned) check_says(check.rows[row].check.reason, "nothing-below");
    }
    CHECK(check.verdict == SectionVerdict::kUnknown);
    if (!ways) check_says(check.reason, "line 4 of table.csv");
  }
}

TEST_CASE("rows by station lie where the path has these stations, which have to ascend") {
  const Section section(section_of({{1, 4, 2, 7}}));
  std::vector<double> station;
  for (int i = 0; i < 20; ++i) station.push_back(100 + 2 * i);
  OutlineTable table = table_of({{100, 112}, {112, 140}}, box(-1, 1, 0.5, 3));
  table.by_station = true;
  const OutlineTableCheck check = section.check(table, {}, station);
  CHECK(check.verdict == SectionVerdict::kPasses);
  check_near(check.rows[0].chainage_to, 6, 1e-12);
  check_near(check.rows[1].chainage_to, 21, 1e-12);
  check_refused([&] { section.check(table); }, "no stations");
  check_refused([&] { section.check(table, {}, std::vector<double>(3, 1.0)); }, "3 stations");
  station[7] = station[6];
  check_refused([&] { section.check(table, {}, station); }, "do not ascend from pose 6");
}
