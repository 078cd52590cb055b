#include <string>

#include "clearway/error.hpp"
#include "clearway/outline.hpp"
#include "clearway/query.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("an outline is read as y and z, or as one half of a symmetric one") {
  ScratchFolder scratch;
  const std::vector<OutlinePoint> triangle{{-1, 0}, {1, 0}, {0, 2}};
  CHECK(read_outline(scratch.write("a.csv", "y,z\n-1,0\n1,0\n0,2\n")) == triangle);
  CHECK(read_outline(scratch.write("a.csv", "\"y\",\"z\"\r\"-1\",\"0\"\r\"1\",\"0\"\r0,\"2\"\r")) ==
        triangle);
  CHECK(read_outline(scratch.write("b.txt", "-1 0\n\n1 0\n0 2\n-1 0\n")) == triangle);
  CHECK(read_outline(scratch.write("c.csv", "y;z\r\n-1000;0\r\n1000;0\r\n0;2000\r\n"),
                     {.unit = kMetresPerMillimetre}) == triangle);
  const std::vector<OutlinePoint> gauge{{1.5, 0}, {1.5, 3}, {0, 4}, {-1.5, 3}, {-1.5, 0}};
  CHECK(read_outline(scratch.write("d.csv", "height,half_width\n0,1.5\n3,1.5\n4,0\n"),
                     {.mirror = true}) == gauge);
}

TEST_CASE("one half of an outline that is not mirrored is warned of") {
  struct Row {
    const char* text;
    bool mirror, warned;
  };
  ScratchFolder scratch;
  for (const Row& row :
       {Row{"0,0\n1.5,0\n1.5,3\n0,4\n", false, true},
        Row{"y,z\n-1.5,0\n0,0\n0,4\n-1.5,3\n", false, true},
        Row{"1.5,0\n1.5,3\n0,4\n0,0\n1.5,0\n", false, true},
        Row{"-1.5,0\n1.5,0\n1.5,3\n0,4\n-1.5,3\n", false, false},
        Row{"0.1,0\n1.5,0\n1.5,3\n0.1,3\n", false, false}, Row{"0,0\n1.5,1\n1.5,3\n", false, false},
        Row{"0,1.5\n3,1.5\n4,0\n", true, false}}) {
    CAPTURE(row.text);
    std::vector<Message> messages;
    read_outline(scratch.write("a.csv", row.text), {.mirror = row.mirror}, &messages);
    CHECK((messages.size() == 1 && messages[0].code == "half-outline") == row.warned);
    CHECK((messages.empty() || row.warned));
  }
}

TEST_CASE("an outline that is malformed is refused with its line") {
  ScratchFolder scratch;
  const auto refused = [&](const std::string& text, bool mirror, const std::string& words) {
    CAPTURE(text);
    check_refused([&] { return read_outline(scratch.write("a.csv", text), {.mirror = mirror}); },
                  words);
  };
  refused("", false, "holds no corner");
  refused("y,z\n", false, "holds no corner");
  refused("height,half_width\n0,1\n", false, "is to be mirrored with --mirror");
  refused("y,z\n0,1\n", true, "not to be mirrored");
  refused("x,y\n0,1\n", false, "line 1: \"x,y\"; expected two numbers, or first the names y,z");
  refused("y,z\n0,1,2\n", false, "line 2: \"0,1,2\"; expected two finite numbers");
  refused("y,z\n0,1\nnan,2\n", false, "line 3: \"nan,2\"; expected two finite numbers");
  refused("0,1\ny,z\n", false, "line 2");
  refused("y,z\n0,5;1,2\n", false, "line 2: \"0,5;1,2\" has decimal commas");
  refused("0,5;1,2\n", false, "line 1: \"0,5;1,2\" has decimal commas");
  refused("PK\x03\x04", false, "is a ZIP archive");
  refused("0,1\n1,-1\n", true, "expected half a width of 0 or more");
  std::string many;
  for (std::size_t i = 0; i <= kMostOutlinePoints; ++i) many += "1 2\n";
  refused(many, false, "has more corners than 10,000");
}

TEST_CASE("a box is a model without a file, in metres or in named units") {
  const Model box = read_model("box:30,5,4.3", {.as = ModelAs::kSolid});
  check_equal(box.vertices.size(), 8);
  check_equal(box.triangles.size(), 12);
  check_equal(box.solid_count(), 1);
  CHECK(box.vertices[0] == Vec3{-15, -2.5, 0});
  CHECK(read_model("box:3000cm,5 m,4.3", {.as = ModelAs::kSolid}) == box);
  const Model feet = read_model("box:30,5,4.3", {.environment_unit = kMetresPerFoot});
  CHECK(feet.vertices[0].x == Approx(-15 / 0.3048));
  for (const char* text : {"box:", "box:1,2", "box:1,2,3,4", "box:1,2,0", "box:1,2,-3", "box:a,b,c",
                           "box:1,,2", "box:1,2,3,", "box:1,2,inf"}) {
    CAPTURE(text);
    check_refused([&] { return read_model(text); }, "expected a box as box:LENGTH,WIDTH,HEIGHT");
  }
}
