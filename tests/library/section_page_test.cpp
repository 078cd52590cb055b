// What stops a load on each stretch, the points that block cells, and the pages that show them.
#include <cmath>
#include <map>
#include <string>

#include "clearway/report.hpp"
#include "library/section_guarantee.hpp"
#include "support/section_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A box as the outline of a load.
struct Outline {
  double right, left, low, high;

  void give_way(Side side, double depth) {
    if (side == Side::kLeft) left -= depth;
    if (side == Side::kRight) right += depth;
    if (side == Side::kAbove) high -= depth;
    if (side == Side::kBelow) low += depth;
  }
  bool is_left() const { return left - right > 1e-6 && high - low > 1e-6; }
  std::vector<OutlinePoint> points() const {
    return {{right, low}, {left, low}, {left, high}, {right, high}};
  }
};

void block(SectionData& data, std::uint32_t bin, int k, int j, std::uint32_t pose) {
  data.bin_cells.bin.push_back(bin);
  data.bin_cells.k.push_back(k);
  data.bin_cells.j.push_back(j);
  data.bin_cells.first_pose.push_back(pose);
}

/// A section with cells of 0.1 and bins of 5, in which blobs block cells.
SectionData blobs(Random& random, int columns = 80, int rows = 50, std::uint32_t bins = 4,
                  int count = 3) {
  SectionData data;
  data.parameters = {.rear = -1,
                     .front = 1,
                     .window = SectionWindow{-0.05 * columns, 0.05 * columns, 0, 0.1 * rows},
                     .cell = 0.1,
                     .bin = 5,
                     .margin = 1};
  data.rounding = 1e-12;
  data.environment_points = 1000;
  data.poses = data.load_poses = 5 * bins;
  data.length_unit = "metre";
  for (std::uint32_t i = 0; i < 5 * bins; ++i) data.chainage.push_back(i);
  for (std::uint32_t bin = 0; bin < bins; ++bin) {
    data.bins.push_back(bin);
    std::map<std::array<int, 2>, std::uint32_t> cells;  // k, j
    for (int blob = 0; blob < count; ++blob) {
      const double y = uniform(random, -3, 3), z = uniform(random, 0, 4.9);
      const double reach = uniform(random, 0.1, 0.9);
      for (int k = 0; k < rows; ++k) {
        for (int j = -columns / 2; j < columns / 2; ++j) {
          if (std::hypot(0.1 * j - y, 0.1 * k - z) > reach) continue;
          cells[{k, j}] = 5 * bin + static_cast<std::uint32_t>(below(random, 5));
        }
      }
    }
    for (const auto& [at, pose] : cells) block(data, bin, at[0], at[1], pose);
  }
  return data;
}

/// Whether a load is stopped in a bin.
bool stops_in(const SectionCheck& check, std::uint32_t bin) {
  return std::ranges::any_of(check.stops, [&](const SectionStop& s) { return s.bin == bin; });
}

}  // namespace

TEST_CASE("a load that gives way as its intrusions say passes, and no single side takes less") {
  Random random(1);
  int stops = 0, singles = 0, sides = 0, tight = 0;
  for (int scene = 0; scene < 60; ++scene) {
    const Section section(blobs(random));
    const Outline load{uniform(random, -2.5, -1), uniform(random, 1, 2.5), uniform(random, 0.2, 1),
                       uniform(random, 3, 4.5)};
    const double margin = below(random, 2) == 0 ? 0.0 : uniform(random, 0.05, 0.4);
    for (const SectionStop& stop : section.check(load.points(), margin).stops) {
      ++stops;
      REQUIRE_FALSE(stop.intrusions.empty());
      Outline smaller = load;
      double sum = 0;
      std::uint64_t cells = 0;
      for (const SectionIntrusion& in : stop.intrusions) {
        smaller.give_way(in.side, in.depth + 1e-9);
        sum += in.depth;
        cells += in.cells;
        CHECK(in.chainage == section.data().chainage[in.first_pose]);
        CHECK((in.y_from <= 0.1 * in.cell[0] + 1e-9 && 0.1 * in.cell[0] <= in.y_to));
        CHECK((in.z_from <= 0.1 * in.cell[1] + 1e-9 && 0.1 * in.cell[1] <= in.z_to));
      }
      CHECK(cells > 0);
      if (smaller.is_left()) {
        CHECK_FALSE(stops_in(section.check(smaller.points(), margin), stop.bin));
        // With a little less it is stopped; at the round corners of a margin less may be enough.
        for (const SectionIntrusion& in : stop.intrusions) {
          if (margin > 0 || stop.intrusions.size() > 1) continue;
          ++tight;
          Outline larger = smaller;
          larger.give_way(in.side, -1e-6);
          CHECK(stops_in(section.check(larger.points(), margin), stop.bin));
        }
      }
      for (const Side side : {Side::kLeft, Side::kRight, Side::kAbove, Side::kBelow}) {
        Outline other = load;
        other.give_way(side, sum - 1e-6);
        if (margin > 0 || !other.is_left() || !smaller.is_left()) continue;
        ++sides;
        CHECK(stops_in(section.check(other.points(), margin), stop.bin));
      }
      if (stop.intrusions.size() == 1) ++singles;
    }
  }
  CHECK(stops > 100);
  CHECK(singles > 20);
  CHECK(sides > 50);
  CHECK(tight > 20);
}

TEST_CASE("what is left of a load decides between its sides") {
  Random random(2);
  SectionData data = blobs(random, 80, 50, 1, 0);
  const auto stops = [&] { return Section(data).check(Outline{-2, 2, 0.5, 4}.points(), 0).stops; };
  for (int k = 5; k < 30; ++k) block(data, 0, k, 15, 0);  // a trunk: y = 1.5 to 1.6, z = 0.5 to 3
  const auto trunk = stops();
  REQUIRE(trunk.size() == 1);
  REQUIRE(trunk[0].intrusions.size() == 1);
  CHECK(trunk[0].intrusions[0].side == Side::kLeft);
  CHECK(trunk[0].intrusions[0].depth == Approx(0.5));
  CHECK(trunk[0].intrusions[0].cells == 25);
  for (int j = -40; j < 40; ++j) block(data, 0, 38, j, 0);  // a wire across the road at z = 3.8
  const auto wire = stops();
  REQUIRE(wire[0].intrusions.size() == 2);
  CHECK(wire[0].intrusions[0].side == Side::kLeft);
  CHECK(wire[0].intrusions[1].side == Side::kAbove);
  CHECK(wire[0].intrusions[1].depth == Approx(0.2));
}

namespace {

/// A tube, and the section of a load on pivots in it.
struct PivotTube : Tube {
  PivotTube() : Tube(3) {
    asked = {.rear = -3,
             .front = 3,
             .window = SectionWindow{-3, 3, -0.5, 4.5},
             .cell = 0.1,
             .bin = 4,
             .margin = 0.2,
             .pivots = BodyPivots{2, -2},
             .ignore_boxes = {Box{{5, 0, 0}, {8, 2, 1}}}};
    find();
  }
};

}  // namespace

TEST_CASE("the witness of a cell is the first point that lies in it at its pose") {
  const PivotTube tube;
  const Section section = tube.section();
  const SectionData& data = section.data();
  const Store store(tube.folder / "tube.h5");
  const Body body = follow({"load", {}, {}, {}}, tube.path, BodyPivots{2, -2});
  const MovingBody load{body.name, body.model, body.poses, body.path_pose};
  std::vector<SectionPlace> places;
  const SectionCells& cells = data.bin_cells;
  for (std::size_t i = 0; i < cells.size(); i += 3) {
    places.push_back({cells.first_pose[i], {cells.j[i], cells.k[i]}});
  }
  places.push_back({0, {0, 0}});  // the load has no pose there
  const auto found = section_witnesses(data, store, tube.path, places);
  REQUIRE(found.size() == places.size());
  CHECK_FALSE(found.back());
  const auto is_in = [&](const SectionPlace& place, const Vec3& p, double slack) {
    if (data.parameters.ignore_boxes[0].contains(p)) return false;
    const auto [x, y, z] = place_of(*load.pose_at(place.pose), p);
    const double right = 0.1 * place.cell[0], low = 0.1 * place.cell[1];
    return x >= -3.2 - slack && x <= 3.2 + slack && y >= right - slack &&
           y <= right + 0.1 + slack && z >= low - slack && z <= low + 0.1 + slack;
  };
  REQUIRE(places.size() > 300);
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    REQUIRE(found[i]);
    CHECK(length(found[i]->xyz - tube.points[found[i]->source]) < 1e-5);
    CHECK(is_in(places[i], found[i]->xyz, 1e-9));
    for (std::uint64_t source = 0; source < found[i]->source; ++source) {
      if (is_in(places[i], tube.points[source], -1e-5)) {
        FAIL_CHECK("point " << source << " comes before " << found[i]->source);
      }
    }
  }
}

TEST_CASE("witnesses are those of the section's own store and path") {
  const PivotTube tube;
  const SectionData data = tube.section().data();
  const std::vector<SectionPlace> places{{10, {0, 1}}};
  write_ply(tube.folder / "other.ply", std::vector<Vec3>{{1, 2, 3}});
  convert({tube.folder / "other.ply"}, tube.folder / "other.h5", {});
  CHECK_THROWS_WITH(section_witnesses(data, Store(tube.folder / "other.h5"), tube.path, places),
                    Contains("another environment"));
  std::vector<Pose> shorter(tube.path.begin(), tube.path.end() - 1);
  CHECK_THROWS_WITH(section_witnesses(data, Store(tube.folder / "tube.h5"), shorter, places),
                    Contains("another trajectory"));
}

TEST_CASE("obstacles are read from the conflicts that were written, with names of one's own") {
  const ScratchFolder folder;
  const auto read = [&](const std::string& text) {
    return read_obstacles(folder.write("c.csv", text));
  };
  const std::string head = "id,points,lo_x,lo_y,lo_z,hi_x,hi_y,hi_z";
  const auto plain = read(head + "\n3,10,1,2,3,4,5,6\r\n\n7,1,-1,-1,-1,0,0,0\n");
  REQUIRE(plain.size() == 2);
  CHECK(plain[0].name == "conflict 3");
  CHECK(plain[0].box.hi.y == 5);
  CHECK(plain[1].box.lo.x == -1);
  CHECK(read(head + ",name\n3,10,1,2,3,4,5,6,\"tree, \"\"old\"\"\"\n")[0].name == "tree, \"old\"");
  const auto refused = [&](const std::string& text, const char* words) {
    check_refused([&] { read(text); }, words);
  };
  refused("", "is empty");
  refused("id,lo_x\n1,2\n", "line 1 ... lo_y");
  refused(head + "\n1,2,3\n", "line 2 ... 3 columns; expected 8");
  refused(head + "\n1,2,3,x,5,6,7,8\n", "line 2 ... \"x\"");
  refused(head + "\n1,2,3,nan,5,6,7,8\n", "finite");
  refused(head + "\n1,2,9,4,5,6,7,8\n", "ends before it begins");
  refused(head + "\n\"1,2\n", "quote");
  refused(head + ",name\n3,10,1,2,3,4,5,6,\"tree\n", "line 2 ... a quote has no end");
  refused(head + ",lo_x\n3,10,1,2,3,4,5,6,1\n", "line 1 ... two columns for lo_x");
  refused("id,points,lo_x [ft],lo_y,lo_z,hi_x,hi_y,hi_z\n", "line 1 ... expected no unit");
}

TEST_CASE("a page refuses what does not belong to its section") {
  const PivotTube tube;
  const Section section = tube.section();
  const Store store(tube.folder / "tube.h5");
  const auto file = tube.folder / "page.html";
  SectionPageOptions options;
  const auto refused = [&](const char* words) {
    check_refused([&] { write_section_page(section, file, options); }, words);
  };
  const NamedObstacle near{"tree", Box{{10, 0, 0.35}, {12, 2, 2}}};
  options.outline = Outline{-2, 2, -0.1, 2}.points();
  options.obstacles = {near};
  refused("need the store");
  options.store = &store;
  options.path = &tube.path;
  options.obstacles = {near, {"tree", Box{{100, 0, 0}, {112, 2, 2}}}};
  refused("outside of the environment");
  options.obstacles = {near};
  options.outline = {{0, 0}, {1, 1}};
  CHECK_THROWS_AS(write_section_page(section, file, options), UsageError);
  options.outline = Outline{-2, 2, -0.1, 2}.points();
  options.heights.base = 9;
  refused("no band");
  options.heights.base = 0;
  CHECK_FALSE(std::filesystem::exists(file));
  const SectionPageSummary summary = write_section_page(section, file, options);
  CHECK(summary.bytes == std::filesystem::file_size(file));
  refused("exists");
  CHECK(summary.sentence.starts_with("stopped"));
  check_says(summary.facts, "\"tree\"");
}

TEST_CASE("cells that are not known are hatched in the picture and on the page") {
  const PivotTube tube;
  const Section section = tube.section();
  SectionPageOptions options;
  const auto picture = [&](const Section& of) {
    write_section_picture(of, tube.folder / "picture.svg", options, true);
    return bytes_of(tube.folder / "picture.svg");
  };
  check_lacks(picture(section), "class=\"unknown\"");
  SectionData data = section.data();
  // From the window's corner at j = -30 and k = -5: columns 28 and 29 of rows 10 and 11.
  data.unknown = SectionCells{.bin = std::vector(4, data.bins[0]),
                              .j = {-2, -1, -2, -1},
                              .k = {5, 5, 6, 6},
                              .first_pose = std::vector(4, 0U)};
  const Section with_unknown(std::move(data));
  check_says(picture(with_unknown),
             "<path class=\"unknown\" fill=\"url(#section_unknown)\" "
             "d=\"M28 10h2v1h-2zM28 11h2v1h-2z\"/>");
  write_section_page(with_unknown, tube.folder / "page.html", options);
  check_says(bytes_of(tube.folder / "page.html"), "data-column=\"section.unknown\"");
}

TEST_CASE("what reaches in on one side in stretches one after the other is one place") {
  Random random(5);
  SectionData data = blobs(random, 80, 50, 60, 0);
  for (std::uint32_t bin = 0; bin < 60; ++bin) {
    if (bin != 30) block(data, bin, 10, -14, 5 * bin);  // a walkway on the right with a gap
    if (bin == 7 || bin == 8) block(data, bin, 20, 12, 5 * bin);
  }
  const Section section(data);
  const ScratchFolder folder;
  SectionPageOptions options;
  options.outline = Outline{-1.5, 1.5, 0.4, 3}.points();
  write_section_page(section, folder / "page.html", options);
  const std::string page = bytes_of(folder / "page.html");
  const std::string places = page.substr(page.find("\"places\":["));
  check_says(places, "\"chainage_from\":0,\"chainage_to\":150");
  check_says(places, "\"chainage_from\":155,\"chainage_to\":299");
  check_says(places, "\"chainage_from\":35,\"chainage_to\":45");
  const std::string label = "\"label\":";
  int labels = 0;
  for (std::size_t at = 0; (at = page.find(label, at)) != page.npos; ++at) ++labels;
  CHECK(labels == 3);
}

TEST_CASE("a page of a hundred stretches of a fine section stays below 5 MB") {
  Random random(4);
  const Section section(blobs(random, 400, 300, 100, 14));
  const ScratchFolder folder;
  SectionPageOptions options;
  options.outline = Outline{-1.5, 1.5, 0.4, 3}.points();
  const std::uint64_t bytes = write_section_page(section, folder / "page.html", options).bytes;
  INFO(section.data().bin_cells.size() << " cells, " << bytes << " bytes");
  CHECK(section.data().bin_cells.size() > 100'000);
  CHECK(bytes < 5'000'000);
}
