// Tables of widths against a program that knows only their definition.
#include "core/section/section_tables.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/section.hpp"
#include "core/section/section_map.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct Cell {
  int bin, j, k, pose;
};

/// A section of random cells in a random window, and heights of its tables.
struct TableTrial {
  explicit TableTrial(Random& random) {
    const double sides[] = {0.02, 0.05, 0.1, 0.25, uniform(random, 0.01, 0.4)};
    cell = sides[below(random, 5)];
    const auto length = [&](double from, double to) {
      const double any = uniform(random, from, to);
      return below(random, 2) == 0 ? any : std::round(any / 0.01) * 0.01;
    };
    window = {length(-3, -0.3), length(0.3, 3), 0, 0};
    window.z_from = below(random, 3) == 0 ? 0 : length(-2, 1);
    window.z_to = window.z_from + length(1, 4);
    j_from = static_cast<int>(std::floor(window.y_from / cell));
    j_to = static_cast<int>(std::ceil(window.y_to / cell));
    k_from = static_cast<int>(std::floor(window.z_from / cell));
    k_to = static_cast<int>(std::ceil(window.z_to / cell));
    std::set<std::array<int, 3>> places;  // bin, k, j
    for (std::uint64_t n = below(random, 40); n > 0; --n) {
      places.insert(
          {static_cast<int>(below(random, 3)),
           k_from + static_cast<int>(below(random, static_cast<std::uint64_t>(k_to - k_from))),
           j_from + static_cast<int>(below(random, static_cast<std::uint64_t>(j_to - j_from)))});
    }
    for (const auto& [bin, k, j] : places) cells.push_back({bin, j, k, 5 * bin});
    if (below(random, 3) > 0) heights.base = length(window.z_from - 0.5, window.z_to - 0.3);
    heights.band = below(random, 4) == 0 ? 0 : length(0.05, 0.8);
  }

  Section section() const {
    SectionData data;
    data.parameters = {
        .rear = -1, .front = 1, .window = window, .cell = cell, .bin = 5, .margin = 0};
    data.rounding = 1e-9;
    data.environment_points = 1000;
    data.length_unit = "metre";
    data.poses = data.load_poses = 15;
    for (int i = 0; i < 15; ++i) data.chainage.push_back(i);
    data.bins = {0, 1, 2};
    for (const Cell& at : cells) {
      data.bin_cells.bin.push_back(static_cast<std::uint32_t>(at.bin));
      data.bin_cells.j.push_back(at.j);
      data.bin_cells.k.push_back(at.k);
      data.bin_cells.first_pose.push_back(static_cast<std::uint32_t>(at.pose));
    }
    return Section(std::move(data));
  }

  double cell = 0;
  SectionWindow window{};
  int j_from = 0, j_to = 0, k_from = 0, k_to = 0;
  std::vector<Cell> cells;
  SectionHeights heights;
};

/// By the definition: the widths between two heights, of one bin or of all.
struct Widths {
  std::optional<double> left, right;
  int left_pose = 0, right_pose = 0;  ///< of the nearest cells the first

  Widths(const TableTrial& trial, double z_from, double z_to, std::optional<int> bin) {
    const double g = trial.cell, same = 1e-6 * g;
    for (const Cell& at : trial.cells) {
      if (bin && at.bin != *bin) continue;
      const double common = std::min(z_to, (at.k + 1) * g) - std::max(z_from, at.k * g);
      if (common <= same) continue;
      const double width = (at.j >= 0 ? at.j : -at.j - 1) * g;
      std::optional<double>& least = at.j >= 0 ? left : right;
      int& pose = at.j >= 0 ? left_pose : right_pose;
      if (!least || width < *least || (width == *least && at.pose < pose)) pose = at.pose;
      if (!least || width < *least) least = width;
    }
  }
};

void check_band(const TableTrial& trial, const SectionBand& band, double z_from, double z_to,
                std::optional<int> bin) {
  const Widths expected(trial, z_from, z_to, bin);
  INFO("z " << z_from << " to " << z_to << ", cells of " << trial.cell);
  check_near(band.z_from, z_from, 1e-9);
  check_near(band.z_to, z_to, 1e-9);
  const auto same = [](const std::optional<HalfWidth>& half, const std::optional<double>& width,
                       int pose) {
    return half.has_value() == width.has_value() &&
           (!half || (std::abs(half->width - *width) < 1e-9 &&
                      half->first_pose == static_cast<std::uint32_t>(pose)));
  };
  CHECK(same(band.left, expected.left, expected.left_pose));
  CHECK(same(band.right, expected.right, expected.right_pose));
}

void check_all_refused(const Section& section, const SectionHeights& heights, const char* words) {
  check_refused([&] { section_bands(section, heights); }, words);
  check_refused([&] { section_boxes(section, heights); }, words);
  check_refused([&] { section_stations(section, heights); }, words);
  check_refused([&] { largest_outline(section, heights); }, words);
}

}  // namespace

TEST_CASE("tables of widths are those of their cells, whatever window, base and band") {
  Random random(2026);
  int refused = 0, rows = 0, open = 0, above_ground = 0, lifted = 0;
  for (int i = 0; i < 240; ++i) {
    const TableTrial trial(random);
    const Section section = trial.section();
    const double bottom = trial.k_from * trial.cell, top = trial.k_to * trial.cell;
    const double band = trial.heights.band == 0 ? 0.1 : trial.heights.band;
    INFO("trial " << i << ", window z " << bottom << " to " << top << ", band " << band);
    if (trial.heights.base && *trial.heights.base < bottom - 1e-6 * trial.cell) {
      check_all_refused(section, trial.heights, "below the window");
      ++refused;
      continue;
    }
    const double base = trial.heights.base.value_or(bottom <= 0 && top > 0 ? 0 : bottom);
    std::vector<std::pair<double, double>> expected;
    for (int n = 0; base + (n + 1) * band <= top + 1e-6 * band; ++n) {
      expected.push_back({base + n * band, base + (n + 1) * band});
    }
    if (expected.empty()) {
      check_refused([&] { return section_bands(section, trial.heights); }, "no band");
      continue;
    }
    above_ground += bottom > 0 && !trial.heights.base ? 1 : 0;
    const auto bands = section_bands(section, trial.heights);
    const auto boxes = section_boxes(section, trial.heights);
    const auto stations = section_stations(section, trial.heights);
    REQUIRE(bands.size() == expected.size());
    // Without a base, boxes begin at the lowest band in whose middle there is room.
    std::size_t lowest = 0;
    const auto has_room = [&](const std::pair<double, double>& heights) {
      const Widths room(trial, heights.first, heights.second, {});
      return std::min(room.left.value_or(trial.j_to * trial.cell),
                      room.right.value_or(-trial.j_from * trial.cell)) > 4e-9;
    };
    if (!trial.heights.base) {
      while (lowest < expected.size() && !has_room(expected[lowest])) ++lowest;
      if (lowest == expected.size()) lowest = 0;
    }
    lifted += lowest > 0 ? 1 : 0;
    REQUIRE(boxes.size() == expected.size() - lowest);
    REQUIRE(stations.size() == 3);
    for (std::size_t n = 0; n < expected.size(); ++n) {
      const auto [from, to] = expected[n];
      check_band(trial, bands[n], from, to, {});
      if (n >= lowest) check_band(trial, boxes[n - lowest], expected[lowest].first, to, {});
      for (int bin = 0; bin < 3; ++bin) {
        check_band(trial, stations[static_cast<std::size_t>(bin)].bands[n], from, to, bin);
      }
      ++rows;
      const Widths widths(trial, from, to, {});
      const auto symmetric = symmetric_width(section.data(), bands[n]);
      CHECK(symmetric.has_value() == (widths.left || widths.right));
      if (!symmetric) {
        ++open;
        continue;
      }
      // An open side ends at the border of the window.
      const double least = std::min(widths.left.value_or(trial.j_to * trial.cell),
                                    widths.right.value_or(-trial.j_from * trial.cell));
      check_near(*symmetric, std::max(0.0, 2 * least - 2e-9), 1e-9);
    }
  }
  CAPTURE(refused, rows, open, above_ground, lifted);
  CHECK(refused > 15);
  CHECK(rows > 1000);
  CHECK(open > 100);
  CHECK(above_ground > 10);
  CHECK(lifted > 3);
}

TEST_CASE("a section in doubt has no widths") {
  Random random(3);
  TableTrial trial(random);
  trial.heights = {};
  for (const char* code : {"no-points", "no-poses", "all-ignored", "out-of-reach"}) {
    SectionData data = trial.section().data();
    data.warnings.push_back({Message::Severity::kWarning, code, "text"});
    const Section section(std::move(data));
    check_all_refused(section, {}, code);
  }
}

// The map of first poses and its pyramid against all cells of a rectangle.

TEST_CASE("a pyramid over first poses says whether all cells of a rectangle are blocked early") {
  Random random(7);
  const auto number = [&](std::uint32_t most) {
    return static_cast<std::uint32_t>(below(random, most));
  };
  std::size_t yes = 0, no = 0;
  for (int i = 0; i < 60; ++i) {
    const double columns = 1 + number(90), rows = 1 + number(90);
    const SectionLattice lattice = section_lattice(
        {.rear = 0, .front = 1, .window = SectionWindow{0, columns, 0, rows}, .cell = 1, .bin = 1},
        0);
    SectionMaps maps(lattice, 2);
    const SectionMapRef map = maps[1];
    std::vector<std::uint32_t> firsts(lattice.cells(), kNotBlocked);
    const std::uint32_t poses = 1 + number(6);
    const std::uint32_t updates = number(3 * static_cast<std::uint32_t>(lattice.cells()));
    for (std::uint32_t update = 0; update < updates; ++update) {
      const std::uint32_t column = number(lattice.columns), row = number(lattice.rows);
      const std::uint32_t pose = number(poses);
      map.block(column, row, pose);
      std::uint32_t& first = firsts[row * lattice.columns + column];
      first = std::min(first, pose);
    }
    CHECK(std::ranges::equal(firsts, maps.firsts(1)));
    CHECK(std::ranges::all_of(maps.entries().first(maps.shape().entries),
                              [](std::uint32_t entry) { return entry == kNotBlocked; }));
    for (int question = 0; question < 300; ++question) {
      const std::uint32_t side = 1 + number(question % 3 == 0 ? 90 : 5);
      SectionRect rect{number(lattice.columns), 0, number(lattice.rows), 0};
      rect.column_to = std::min(rect.column_from + number(side), lattice.columns - 1);
      rect.row_to = std::min(rect.row_from + number(side), lattice.rows - 1);
      const std::uint32_t pose = number(poses);
      bool expected = true;
      for (std::uint32_t row = rect.row_from; row <= rect.row_to; ++row) {
        for (std::uint32_t column = rect.column_from; column <= rect.column_to; ++column) {
          expected = expected && firsts[row * lattice.columns + column] <= pose;
        }
      }
      CHECK(map.is_blocked_by(rect, pose) == expected);
      CHECK(map.is_blocked_inside(rect, pose) == expected);
      ++(expected ? yes : no);
    }
  }
  CHECK(yes > 2000);
  CHECK(no > 2000);
}
