#include "core/geometry/outline.hpp"

#include <cmath>
#include <map>
#include <vector>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Outline = std::vector<OutlinePoint>;

double area_of(const Outline& outline) {
  long double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const OutlinePoint &a = outline[i], &b = outline[(i + 1) % outline.size()];
    twice += static_cast<long double>(a.y) * b.z - static_cast<long double>(a.z) * b.y;
  }
  return std::abs(static_cast<double>(twice / 2));
}

/// Six times the volume that the triangles enclose, and whether they are closed: each edge is
/// there once in each direction.
double volume_of(const Model& solid) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  long double volume = 0;
  for (const auto& t : solid.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      REQUIRE(edges[{t[k], t[(k + 1) % 3]}]++ == 0);
    }
    const Vec3 &p = solid.vertices[t[0]], &q = solid.vertices[t[1]], &r = solid.vertices[t[2]];
    const long double x = p.x, y = p.y, z = p.z;
    volume +=
        x * (q.y * r.z - q.z * r.y) + y * (q.z * r.x - q.x * r.z) + z * (q.x * r.y - q.y * r.x);
  }
  for (const auto& [edge, count] : edges) REQUIRE(edges.contains({edge.second, edge.first}));
  return static_cast<double>(volume / 6);
}

void check_solid(const Outline& outline) {
  const Model solid = outline_model(outline, -2, 5.5);
  const std::size_t n = outline.size();
  REQUIRE(solid.vertices.size() == 2 * n);
  REQUIRE(solid.triangles.size() == 4 * n - 4);
  REQUIRE(solid.solid_count() == 1);
  const double expected = 7.5 * area_of(outline);
  REQUIRE(volume_of(solid) == Approx(expected).epsilon(1e-9).margin(1e-12));
  for (std::size_t t = 0; t < 2 * (n - 2); ++t) {  // the caps come first
    Outline corners;
    for (const std::uint32_t v : solid.triangles[t]) {
      corners.push_back({solid.vertices[v].y, solid.vertices[v].z});
    }
    REQUIRE(side_of(corners[0], corners[1], corners[2]) == (t % 2 == 0 ? -1 : 1));
  }
}

/// A polygon through random places, whose crossing edges are exchanged until none cross. With a
/// coarse grid many corners lie on one line.
Outline untangled(Random& random, std::size_t corners, double grid) {
  Outline out;
  while (out.size() < corners) {
    const OutlinePoint p{std::floor(uniform(random, -20, 20)) * grid,
                         std::floor(uniform(random, 0, 40)) * grid};
    if (std::ranges::find(out, p) == out.end()) out.push_back(p);
  }
  for (int turn = 0; turn < 2000; ++turn) {
    const auto edges = touching_edges(out);
    if (!edges) return out;
    const auto [i, j] = *edges;
    if (j == (i + 1) % out.size()) return {};  // folds back: exchanges do not help
    std::reverse(out.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                 out.begin() + static_cast<std::ptrdiff_t>(j) + 1);
  }
  return {};
}

/// Puts corners on edges: exactly on them where these are level or upright, otherwise one rounding
/// beside them.
Outline with_flat_corners(Random& random, const Outline& from) {
  Outline out;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const OutlinePoint &a = from[i], &b = from[(i + 1) % from.size()];
    out.push_back(a);
    if (below(random, 3) != 0) continue;
    const double part = uniform(random, 0.2, 0.8);
    out.push_back({a.y + part * (b.y - a.y), a.z + part * (b.z - a.z)});
  }
  return out;
}

}  // namespace

TEST_CASE("solids of random outlines are closed, point outwards and have their volume") {
  std::size_t checked = 0, corners = 0;
  for (unsigned seed = 0; checked < 1000; ++seed) {
    INFO("seed " << seed);
    REQUIRE(seed < 4000);
    Random random(seed);
    Outline outline = untangled(random, 3 + below(random, 20), seed % 2 == 0 ? 0.1 : 1.0 / 3);
    if (outline.empty()) continue;
    outline = with_flat_corners(random, outline);
    if (touching_edges(outline)) continue;  // a corner beside an edge can cross a neighbour
    if (seed % 3 == 0) std::ranges::reverse(outline);
    check_solid(outline);
    ++checked;
    corners += outline.size();
  }
  CHECK(corners > 8000);
}

TEST_CASE("a corner in the middle of an edge, and a spiral with one ear at each end") {
  check_solid({{0, 0}, {1, 0}, {2, 0}, {1, 2}});
  check_solid({{0, 0}, {2, 0}, {1, 2}, {0.5, 1}});
  Outline spiral;
  for (int i = 0; i <= 401; ++i) {  // out, and back beside itself
    const double turn = 0.1 * std::min(i, 401 - i), radius = (i <= 200 ? 10 : 9) + turn;
    spiral.push_back({radius * std::cos(turn), radius * std::sin(turn)});
  }
  check_solid(spiral);
}

TEST_CASE("the side of a line is exact where rounding would decide it") {
  // The example of Shewchuk's paper: points around a line, each one unit of the last place apart.
  const OutlinePoint b{12, 12}, c{24, 24};
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      const OutlinePoint a{0.5 + i * 0x1p-53, 0.5 + j * 0x1p-53};
      REQUIRE(side_of(a, b, c) == (j > i) - (j < i));
    }
  }
  check_equal(side_of({0, 0}, {1e-90, 1e-90}, {2e-90, 2e-90}), 0);
}

TEST_CASE("outlines that are no simple polygon are refused") {
  struct Row {
    Outline outline;
    const char* words;
  };
  const char* const touch = "cross or touch";
  const char* const no_numbers = "expected numbers from -1e6 to 1e6";
  for (const Row& row :
       {Row{{{0, 0}, {1, 0}}, "2 corners; expected 3 to 10,000"},
        Row{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, touch},
        Row{{{0, 0}, {1, 0}, {2, 0}}, touch},                          // no area
        Row{{{0, 0}, {2, 0}, {1, 0}, {1, 1}}, touch},                  // folds back
        Row{{{0, 0}, {2, 0}, {2, 2}, {1, 0}}, touch},                  // touches an edge
        Row{{{0, 0}, {1, 0}, {1, 0}, {0, 1}}, touch},                  // a corner twice
        Row{{{0, 0}, {3, 0}, {3, 3}, {1, 1}, {2, 1}, {1, 1}}, touch},  // a needle
        Row{{{0, 0}, {1, 0}, {NAN, 1}}, no_numbers}, Row{{{0, 0}, {1, 0}, {0, 2e6}}, no_numbers}}) {
    check_refused([&] { return outline_model(row.outline, 0, 1); }, row.words);
  }
  const Outline sound{{0, 0}, {1, 0}, {0, 1}};
  check_refused([&] { return outline_model(sound, 1, 1); }, "expected its rear");
  check_refused([&] { return outline_model(sound, 0, INFINITY); }, "expected its rear");
}

TEST_CASE("a box stands on the ground with its middle over the origin") {
  const Model box = box_model(30, 5, 4.3);
  check_equal(box.vertices.size(), 8);
  check_equal(box.triangles.size(), 12);
  CHECK(volume_of(box) == Approx(645));
  CHECK(box.vertices.front() == Vec3{-15, -2.5, 0});
  CHECK_THROWS_AS(box_model(0, 1, 1), UsageError);
  CHECK_THROWS_AS(box_model(1, -1, 1), UsageError);
  CHECK_THROWS_AS(box_model(1, 1, NAN), UsageError);
}
