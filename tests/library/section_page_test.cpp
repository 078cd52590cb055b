// What stops a load on each stretch, the points that block cells, and the pages that show them.
#include <cmath>
#include <fstream>
#include <map>
#include <string>

#include "clearway/clearway.hpp"
#include "clearway/error.hpp"
#include "clearway/report.hpp"
#include "clearway/section.hpp"
#include "support/catch.hpp"
#include "support/result_fixture.hpp"
#include "support/scenes.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<OutlinePoint> box(double right, double left, double low, double high) {
  return {{right, low}, {left, low}, {left, high}, {right, high}};
}

/// A section with cells of 0.1, a window of 8 x 5 and bins of 5, in which blobs block cells.
SectionData blobs(Random& random, std::size_t columns = 80, std::size_t rows = 50,
                  std::uint32_t bins = 4, int count = 3) {
  SectionData data;
  data.parameters = {.rear = -1,
                     .front = 1,
                     .window = SectionWindow{-0.05 * static_cast<double>(columns),
                                             0.05 * static_cast<double>(columns), 0,
                                             0.1 * static_cast<double>(rows)},
                     .cell = 0.1,
                     .bin = 5,
                     .margin = 1};
  data.rounding = 1e-12;
  data.environment_points = 1000;
  data.poses = data.load_poses = 5 * bins;
  data.length_unit = "metre";
  const auto half = static_cast<std::int32_t>(columns / 2);
  for (std::uint32_t i = 0; i < 5 * bins; ++i) data.chainage.push_back(i);
  for (std::uint32_t bin = 0; bin < bins; ++bin) {
    data.bins.push_back(bin);
    std::map<std::array<std::int32_t, 2>, std::uint32_t> cells;  // k, j
    for (int blob = 0; blob < count; ++blob) {
      const double y = uniform(random, -3, 3), z = uniform(random, 0, 4.9);
      const double reach = uniform(random, 0.1, 0.9);
      for (std::int32_t k = 0; k < static_cast<std::int32_t>(rows); ++k) {
        for (std::int32_t j = -half; j < half; ++j) {
          if (std::hypot(0.1 * j - y, 0.1 * k - z) > reach) continue;
          cells[{k, j}] = 5 * bin + static_cast<std::uint32_t>(below(random, 5));
        }
      }
    }
    for (const auto& [place, pose] : cells) {
      data.bin_cells.bin.push_back(bin);
      data.bin_cells.k.push_back(place[0]);
      data.bin_cells.j.push_back(place[1]);
      data.bin_cells.first_pose.push_back(pose);
    }
  }
  return data;
}

/// Whether a load is stopped in a bin.
bool stops_in(const SectionCheck& check, std::uint32_t bin) {
  return std::ranges::any_of(check.stops, [&](const SectionStop& s) { return s.bin == bin; });
}

struct Box4 {
  double right, left, low, high;

  void give_way(Side side, double depth) {
    if (side == Side::kLeft) left -= depth;
    if (side == Side::kRight) right += depth;
    if (side == Side::kAbove) high -= depth;
    if (side == Side::kBelow) low += depth;
  }
  bool is_left() const { return left - right > 1e-6 && high - low > 1e-6; }
  std::vector<OutlinePoint> outline() const { return box(right, left, low, high); }
};

}  // namespace

TEST_CASE("a load that gives way as its intrusions say passes, and no single side takes less") {
  Random random(1);
  int stops = 0, singles = 0, sides = 0, tight = 0;
  for (int scene = 0; scene < 60; ++scene) {
    const Section section(blobs(random));
    const Box4 load{uniform(random, -2.5, -1), uniform(random, 1, 2.5), uniform(random, 0.2, 1),
                    uniform(random, 3, 4.5)};
    const double margin = below(random, 2) == 0 ? 0.0 : uniform(random, 0.05, 0.4);
    for (const SectionStop& stop : section.check(load.outline(), margin).stops) {
      ++stops;
      REQUIRE_FALSE(stop.intrusions.empty());
      Box4 smaller = load;
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
        CHECK_FALSE(stops_in(section.check(smaller.outline(), margin), stop.bin));
        // With a little less it is stopped; at the round corners of a margin less may be enough.
        for (const SectionIntrusion& in : stop.intrusions) {
          if (margin > 0 || stop.intrusions.size() > 1) continue;
          ++tight;
          Box4 larger = smaller;
          larger.give_way(in.side, -1e-6);
          CHECK(stops_in(section.check(larger.outline(), margin), stop.bin));
        }
      }
      for (const Side side : {Side::kLeft, Side::kRight, Side::kAbove, Side::kBelow}) {
        Box4 other = load;
        other.give_way(side, sum - 1e-6);
        if (margin > 0 || !other.is_left() || !smaller.is_left()) continue;
        ++sides;
        CHECK(stops_in(section.check(other.outline(), margin), stop.bin));
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
  SectionData data;
  Random random(2);
  data = blobs(random, 80, 50, 1, 0);
  const auto block = [&](int k, int j) {
    data.bin_cells.bin.push_back(0);
    data.bin_cells.k.push_back(k);
    data.bin_cells.j.push_back(j);
    data.bin_cells.first_pose.push_back(0);
  };
  for (int k = 5; k < 30; ++k) block(k, 15);  // a trunk: y = 1.5 to 1.6, z = 0.5 to 3
  const auto trunk = Section(data).check(box(-2, 2, 0.5, 4), 0).stops;
  REQUIRE(trunk.size() == 1);
  REQUIRE(trunk[0].intrusions.size() == 1);
  CHECK(trunk[0].intrusions[0].side == Side::kLeft);
  CHECK(trunk[0].intrusions[0].depth == Approx(0.5));
  CHECK(trunk[0].intrusions[0].cells == 25);
  for (int j = -40; j < 40; ++j) block(38, j);  // a wire across the road at z = 3.8
  const auto wire = Section(data).check(box(-2, 2, 0.5, 4), 0).stops;
  REQUIRE(wire[0].intrusions.size() == 2);
  CHECK(wire[0].intrusions[0].side == Side::kLeft);
  CHECK(wire[0].intrusions[1].side == Side::kAbove);
  CHECK(wire[0].intrusions[1].depth == Approx(0.2));
}

namespace {

/// A road with posts beside it, a path that bends, and the section of a load on pivots.
struct Road {
  Road() {
    Random random(3);
    for (int i = 0; i < 60; ++i) {
      const double angle = 0.01 * i;
      path.push_back(
          rotation({0, 0, 1}, angle, {50 * std::sin(angle), 50 * (1 - std::cos(angle)), 0}));
    }
    for (int i = 0; i < 4000; ++i) {
      points.push_back({uniform(random, -2, 30), uniform(random, -4, 9), uniform(random, 0, 3)});
    }
    for (int i = 0; i < 200; ++i) points.push_back(points[static_cast<std::size_t>(i)]);
    write_ply(folder / "road.ply", points);
    convert({folder / "road.ply"}, folder / "road.h5", {.cell_points = 512, .threads = 2});
    SectionParameters asked{.rear = -3,
                            .front = 3,
                            .window = SectionWindow{-3, 3, 0, 3},
                            .cell = 0.1,
                            .bin = 4,
                            .margin = 0.2,
                            .pivots = BodyPivots{2, -2},
                            .ignore_boxes = {Box{{5, 0, 0}, {8, 2, 1}}}};
    find_section(Store(folder / "road.h5"), path, asked, folder / "section.h5", {.threads = 2});
  }

  ScratchFolder folder;
  std::vector<Vec3> points;
  std::vector<Pose> path;
};

}  // namespace

TEST_CASE("the witness of a cell is the first point that lies in it at its pose") {
  const Road road;
  const Section section(road.folder / "section.h5");
  const SectionData& data = section.data();
  const Store store(road.folder / "road.h5");
  const Body load = follow({"load", {}, {}, {}}, road.path, BodyPivots{2, -2});
  std::map<std::uint32_t, const Pose*> pose_of;
  for (std::size_t i = 0; i < load.poses.size(); ++i) pose_of[load.path_pose[i]] = &load.poses[i];
  std::vector<SectionPlace> places;
  const SectionCells& cells = data.bin_cells;
  for (std::size_t i = 0; i < cells.size(); i += 7) {
    places.push_back({cells.first_pose[i], {cells.j[i], cells.k[i]}});
  }
  places.push_back({0, {0, 0}});  // the load has no pose there
  const auto found = section_witnesses(data, store, road.path, places);
  REQUIRE(found.size() == places.size());
  CHECK_FALSE(found.back());
  const auto place_at = [&](const Pose& pose, const Vec3& p) {
    const Vec3 d = p - pose.position();
    const double* r = pose.rotation;
    return Vec3{r[0] * d.x + r[3] * d.y + r[6] * d.z, r[1] * d.x + r[4] * d.y + r[7] * d.z,
                r[2] * d.x + r[5] * d.y + r[8] * d.z};
  };
  const auto is_in = [&](const SectionPlace& place, const Vec3& p, double slack) {
    if (data.parameters.ignore_boxes[0].contains(p)) return false;
    const Vec3 at = place_at(*pose_of.at(place.pose), p);
    const double y = 0.1 * place.cell[0], z = 0.1 * place.cell[1];
    return at.x >= -3.2 - slack && at.x <= 3.2 + slack && at.y >= y - slack &&
           at.y <= y + 0.1 + slack && at.z >= z - slack && at.z <= z + 0.1 + slack;
  };
  REQUIRE(places.size() > 300);
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    REQUIRE(found[i]);
    CHECK(length(found[i]->xyz - road.points[found[i]->source]) < 1e-5);
    CHECK(is_in(places[i], found[i]->xyz, 1e-9));
    for (std::uint64_t source = 0; source < found[i]->source; ++source) {
      if (is_in(places[i], road.points[source], -1e-5)) {
        FAIL_CHECK("point " << source << " comes before " << found[i]->source);
      }
    }
  }
}

TEST_CASE("witnesses are those of the section's own store and path") {
  const Road road;
  const SectionData data = Section(road.folder / "section.h5").data();
  const std::vector<SectionPlace> places{{10, {0, 1}}};
  write_ply(road.folder / "other.ply", std::vector<Vec3>{{1, 2, 3}});
  convert({road.folder / "other.ply"}, road.folder / "other.h5", {});
  CHECK_THROWS_WITH(section_witnesses(data, Store(road.folder / "other.h5"), road.path, places),
                    Contains("another environment"));
  std::vector<Pose> shorter(road.path.begin(), road.path.end() - 1);
  CHECK_THROWS_WITH(section_witnesses(data, Store(road.folder / "road.h5"), shorter, places),
                    Contains("another trajectory"));
}

namespace {

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string text_in(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

TEST_CASE("obstacles are read from the conflicts that were written, with names of one's own") {
  const ScratchFolder folder;
  const auto read = [&](const std::string& text) {
    write_text(folder / "c.csv", text);
    return read_obstacles(folder / "c.csv");
  };
  const std::string head = "id,points,lo_x,lo_y,lo_z,hi_x,hi_y,hi_z";
  const auto plain = read(head + "\n3,10,1,2,3,4,5,6\r\n\n7,1,-1,-1,-1,0,0,0\n");
  REQUIRE(plain.size() == 2);
  CHECK(plain[0].name == "conflict 3");
  CHECK(plain[0].box.hi.y == 5);
  CHECK(plain[1].box.lo.x == -1);
  CHECK(read(head + ",name\n3,10,1,2,3,4,5,6,\"tree, \"\"old\"\"\"\n")[0].name == "tree, \"old\"");
  CHECK_THROWS_WITH(read(""), Contains("is empty"));
  CHECK_THROWS_WITH(read("id,lo_x\n1,2\n"), Contains("line 1") && Contains("lo_y"));
  CHECK_THROWS_WITH(read(head + "\n1,2,3\n"), Contains("line 2") && Contains("3 fields"));
  CHECK_THROWS_WITH(read(head + "\n1,2,3,x,5,6,7,8\n"), Contains("line 2") && Contains("\"x\""));
  CHECK_THROWS_WITH(read(head + "\n1,2,3,nan,5,6,7,8\n"), Contains("finite"));
  CHECK_THROWS_WITH(read(head + "\n1,2,9,4,5,6,7,8\n"), Contains("ends before it begins"));
  CHECK_THROWS_WITH(read(head + "\n\"1,2\n"), Contains("quote"));
}

TEST_CASE("a page refuses what does not belong to its section") {
  const Road road;
  const Section section(road.folder / "section.h5");
  const Store store(road.folder / "road.h5");
  const auto page = [&](const SectionPageOptions& options) {
    return write_section_page(section, road.folder / "page.html", options);
  };
  const NamedObstacle near{"tree", Box{{10, 0, 0}, {12, 2, 2}}};
  const NamedObstacle far{"tree", Box{{100, 0, 0}, {112, 2, 2}}};
  SectionPageOptions options;
  options.outline = box(-1, 1, 0.5, 2);
  options.obstacles = {near};
  CHECK_THROWS_WITH(page(options), Contains("need the store"));
  options.store = &store;
  options.path = &road.path;
  options.obstacles = {near, far};
  CHECK_THROWS_WITH(page(options), Contains("outside of the environment"));
  options.obstacles = {near};
  options.outline = {{0, 0}, {1, 1}};
  CHECK_THROWS_AS(page(options), UsageError);
  options.outline = box(-1, 1, 0.5, 2);
  options.heights.base = 9;
  CHECK_THROWS_WITH(page(options), Contains("no band"));
  options.heights.base = 0;
  CHECK_FALSE(std::filesystem::exists(road.folder / "page.html"));
  const SectionPageSummary summary = page(options);
  CHECK(summary.bytes == std::filesystem::file_size(road.folder / "page.html"));
  CHECK_THROWS_WITH(page(options), Contains("exists"));
  CHECK(summary.sentence.starts_with("stopped"));
  CHECK(summary.facts.find("\"tree\"") != std::string::npos);
}

TEST_CASE("cells that are not known are hatched in the picture and on the page") {
  const Road road;
  const Section section(road.folder / "section.h5");
  SectionPageOptions options;
  const auto picture = [&](const Section& of) {
    write_section_picture(of, road.folder / "picture.svg", options, true);
    return text_in(road.folder / "picture.svg");
  };
  CHECK(picture(section).find("class=\"unknown\"") == std::string::npos);
  SectionData data = section.data();
  SectionCells& cells = data.unknown.emplace();
  for (const std::int32_t k : {5, 6}) {
    for (const std::int32_t j : {-2, -1}) {
      cells.bin.push_back(data.bins[0]);
      cells.j.push_back(j);
      cells.k.push_back(k);
      cells.first_pose.push_back(0);
    }
  }
  const Section with_unknown(std::move(data));
  // From the window's corner at j = -30: columns 28 and 29 of rows 5 and 6.
  CHECK(picture(with_unknown)
            .find("<path class=\"unknown\" fill=\"url(#section_unknown)\" "
                  "d=\"M28 5h2v1h-2zM28 6h2v1h-2z\"/>") != std::string::npos);
  write_section_page(with_unknown, road.folder / "page.html", options);
  CHECK(text_in(road.folder / "page.html").find("data-column=\"section.unknown\"") !=
        std::string::npos);
}

TEST_CASE("what reaches in on one side in stretches one after the other is one place") {
  Random random(5);
  SectionData data = blobs(random, 80, 50, 60, 0);
  const auto block = [&](std::uint32_t bin, int k, int j) {
    data.bin_cells.bin.push_back(bin);
    data.bin_cells.k.push_back(k);
    data.bin_cells.j.push_back(j);
    data.bin_cells.first_pose.push_back(5 * bin);
  };
  for (std::uint32_t bin = 0; bin < 60; ++bin) {
    if (bin != 30) block(bin, 10, -14);  // a walkway on the right with a gap
    if (bin == 7 || bin == 8) block(bin, 20, 12);
  }
  const Section section(data);
  const ScratchFolder folder;
  SectionPageOptions options;
  options.outline = box(-1.5, 1.5, 0.4, 3);
  write_section_page(section, folder / "page.html", options);
  const std::string page = text_in(folder / "page.html");
  const std::string places = page.substr(page.find("\"places\":["));
  const auto count = [&](const std::string& words, const std::string& text) {
    std::size_t found = 0;
    for (std::size_t at = text.find(words); at != text.npos; at = text.find(words, at + 1)) ++found;
    return found;
  };
  CHECK(count("\"label\":", page) == 3);
  CHECK(count("\"chainage_from\":0,\"chainage_to\":150", places) == 1);
  CHECK(count("\"chainage_from\":155,\"chainage_to\":299", places) == 1);
  CHECK(count("\"chainage_from\":35,\"chainage_to\":45", places) == 1);
}

TEST_CASE("a page of a hundred stretches of a fine section stays below 5 MB") {
  Random random(4);
  const Section section(blobs(random, 400, 300, 100, 14));
  const ScratchFolder folder;
  SectionPageOptions options;
  options.outline = box(-1.5, 1.5, 0.4, 3);
  const std::uint64_t bytes = write_section_page(section, folder / "page.html", options).bytes;
  INFO(section.data().bin_cells.size() << " cells, " << bytes << " bytes");
  CHECK(section.data().bin_cells.size() > 100'000);
  CHECK(bytes < 5'000'000);
}
