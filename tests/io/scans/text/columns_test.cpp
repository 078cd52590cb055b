// Text whose columns are named or chosen, or hold something other than points.
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>

#include "clearway/model.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Columns = std::vector<std::string>;

ReadCloud cloud_of(const std::string& text, const Columns& columns = {}) {
  ScratchFolder scratch;
  return read_all(*open_point_file(scratch.write("a.csv", text), {columns, true}));
}

std::vector<Vec3> points_of_columns(const std::string& text, const Columns& columns = {}) {
  const ReadCloud cloud = cloud_of(text, columns);
  CHECK(cloud.info.remarks.empty());
  return cloud.positions;
}

struct Refusal {
  std::string text;
  Remedy remedy = Remedy::kNone;
  double amount = 0;
};

Refusal refusal_of_columns(const std::string& text, const Columns& columns = {}) {
  try {
    cloud_of(text, columns);
  } catch (const InputError& error) {
    return {error.what(), error.remedy(), error.amount()};
  }
  return {};
}

/// A text of `lines` lines, of which line(i) makes line i.
template <typename Line>
std::string table(int lines, Line line) {
  std::string text;
  for (int i = 0; i < lines; ++i) text += line(i) + "\n";
  return text;
}

template <typename... Numbers>
std::string print(const char* format, Numbers... numbers) {
  char text[512];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

std::string matrix_line(int i, bool last_row) {
  const double a = 0.01 * i;
  return print("%.9f %.9f 0 %g %.9f %.9f 0 %g 0 0 1 0.3", std::cos(a), -std::sin(a), 0.5 * i,
               std::sin(a), std::cos(a), 0.1 * i) +
         (last_row ? " 0 0 0 1" : "");
}

std::string tum_line(int i) {
  const double a = 0.01 * i;
  return print("%.3f %g %g 0.3 0 0 %.6f %.6f", 1700000.5 + 0.1 * i, 0.5 * i, 0.1 * i, std::sin(a),
               std::cos(a));
}

const std::vector<Vec3> kTwoColumns{{1, -2.5, 3e2}, {4, 5, 6}};

}  // namespace

TEST_CASE("numbers in quotes are numbers, and a quoted text is one field") {
  CHECK(points_of_columns("\"X\",\"Y\",\"Z\"\n\"1\",\"-2.5\",\"3e2\"\n\"4\",\"5\",\"6\"\n") ==
        kTwoColumns);
  CHECK(points_of_columns("\"1\" \"-2.5\" \"+3e2\"\n4 5 6\n") == kTwoColumns);
  CHECK(points_of_columns("name;x;y;z\n\"a; 7\";\" 1 \";-2.5;300\nb;4;5;6\n") == kTwoColumns);
  CHECK(points_of_columns("\"a\",\"1\",\"-2.5\",\"300\"\n\"b, 7\",\"4\",\"5\",\"6\"\n",
                          {"2", "3", "4"}) == kTwoColumns);
  for (const char* line :
       {"\"1\",\"2\",\"3", "\"1\"2,3,4", "\"\",2,3", "\"1 2\",3,4", "\"\"1\"\",2,3"}) {
    CAPTURE(line);
    check_says(refusal_of_columns("x,y,z\n1,2,3\n" + std::string(line) + "\n").text, "line 3");
  }
  const auto quoted = [](int i) { return print("\"%d\",\"%d.5\",\"2.5\",\"3.5\"", i, i % 3); };
  check_says(refusal_of_columns(table(20, quoted)).text, "looks like");
}

TEST_CASE("names in a comment count like those in a header") {
  for (const std::string mark : {"#", "//", "# ", "// ", "## ", "# columns: ", "//Fields: "}) {
    INFO(mark);
    CHECK(points_of_columns(mark + "X Y Z\n1 -2.5 3e2\n4 5 6\n") == kTwoColumns);
    CHECK(points_of_columns(mark + "time x y z\n9 1 -2.5 3e2\n9 4 5 6\n") == kTwoColumns);
    CHECK(points_of_columns(mark + "time,x,y,z\n9,1,-2.5,3e2\n9,4,5,6\n") == kTwoColumns);
    CHECK(points_of_columns(mark + "time,x,y,z\n9 1 -2.5 3e2\n9 4 5 6\n") == kTwoColumns);
    CHECK(points_of_columns(mark + "Z X Y R\n3e2 1 -2.5 0\n6 4 5 0\n") == kTwoColumns);
    CHECK(points_of_columns("# made by me\n" + mark +
                            "id;\"X [m]\";Y;Z\n# end\nP1;1;-2.5;3e2\nP2;4;5;6\n") == kTwoColumns);
  }
  CHECK(points_of_columns("//X Y Z R G B\n2\n1 -2.5 3e2 1 2 3\n4 5 6 1 2 3\n") == kTwoColumns);
  CHECK(points_of_columns("//Z Y X\n3e2 -2.5 1 1 2 3\n6 5 4 1 2 3\n") == kTwoColumns);
}

TEST_CASE("a comment that names x, y and z but does not fit the lines is prose or is warned of") {
  CHECK(points_of_columns("# the order is x y z\n1 -2.5 3e2\n4 5 6\n") == kTwoColumns);
  CHECK(points_of_columns("# x y z in metres\n1 -2.5 3e2\n4 5 6\n") == kTwoColumns);
  const ReadCloud cloud = cloud_of("# time x y z intensity\n1 -2.5 3e2 7\n4 5 6 8\n");
  CHECK(cloud.positions == kTwoColumns);
  REQUIRE(cloud.info.remarks.size() == 1);
  CHECK(cloud.info.remarks[0].severity == Message::Severity::kWarning);
  check_equal(cloud.info.remarks[0].code, "column-names");
}

TEST_CASE("easting, northing and heights are x, y and z in whatever order") {
  for (const std::string names :
       {"Easting,Northing,Height", "east,north,Elevation", "E,N,H",
        "Easting [m],Northing [m],Z [m]", "Easting(m),Northing(m),Altitude(m)", "X,Y,Height",
        "x_m,y_m,z_m", "\"X (m)\",\"Y (m)\",Z"}) {
    INFO(names);
    CHECK(points_of_columns(names + "\n1,-2.5,3e2\n4,5,6\n") == kTwoColumns);
    CHECK(points_of_columns("# " + names + "\n1,-2.5,3e2\n4,5,6\n") == kTwoColumns);
  }
  CHECK(points_of_columns("Northing;Easting;Height\n-2.5;1;3e2\n5;4;6\n") == kTwoColumns);
  CHECK(points_of_columns("Point Northing Easting Z\nA -2.5 1 3e2\nB 5 4 6\n") == kTwoColumns);
  CHECK(points_of_columns("X [m] Y [m] Z [m]\n1 -2.5 3e2\n4 5 6\n") == kTwoColumns);
  CHECK(points_of_columns("x y z easting northing height\n1 -2.5 3e2 9 9 9\n4 5 6 9 9 9\n") ==
        kTwoColumns);
  check_says(refusal_of_columns("easting,y,z\n1,2,3\n").text, "line 1");
  check_says(refusal_of_columns("easting,northing,height,altitude\n1,2,3,4\n").text, "line 1");
}

TEST_CASE("units in brackets: feet are told, others than metres and feet refused") {
  CHECK(cloud_of("X [m],Y [m],Z [m]\n1,2,3\n").info.unit == LengthUnit::kMetre);
  CHECK(cloud_of("X [ft],Y [ft],Z [ft]\n1,2,3\n").info.unit == LengthUnit::kFoot);
  CHECK(cloud_of("# Easting (us-ft), Northing (us-ft), Z (us-ft)\n1,2,3\n").info.unit ==
        LengthUnit::kUsSurveyFoot);
  CHECK(cloud_of("X,Y,Z\n1,2,3\n").info.unit == LengthUnit::kUnknown);
  CHECK(cloud_of("X [local],Y [local],Z [local]\n1,2,3\n").info.unit == LengthUnit::kUnknown);
  for (const std::string unit : {"mm", "cm", "inch", "deg", "km"}) {
    const std::string header = "X [" + unit + "],Y [" + unit + "],Z [" + unit + "]\n";
    check_says(refusal_of_columns(header + "1,2,3\n").text,
               std::string("in ") + unit + " ... metres");
  }
  check_says(refusal_of_columns("x_mm,y_mm,z_mm\n1,2,3\n").text, "in mm");
  check_says(refusal_of_columns("X [m],Y [ft],Z [m]\n1,2,3\n").text, "m and ft");
  check_says(refusal_of_columns("X [m],Y [m],Z [deg]\n1,2,3\n").text, "in deg");
  for (const auto& [unit, metres] :
       {std::pair("m", 1.0), std::pair("ft", 0.3048), std::pair("mm", 0.001)}) {
    const auto info = cloud_of("X [m],Y [m],Z [" + std::string(unit) + "]\n1,2,3\n").info;
    CHECK(info.unit == LengthUnit::kMetre);
    CHECK(info.height_unit == metres);
  }
  CHECK(cloud_of("X,Y,Z [ft]\n1,2,3\n").info.unit == LengthUnit::kFoot);
}

TEST_CASE("names of a trajectory and of angles are refused") {
  const auto check = [](const std::string& text, const std::string& what) {
    const Refusal refusal = refusal_of_columns(text);
    check_says(refusal.text, "line ... looks like ... " + what);
    CHECK(refusal.remedy == Remedy::kColumns);
  };
  for (const std::string mark : {"", "# ", "#"}) {
    check(mark + "timestamp,x,y,z,qx,qy,qz,qw\n1,2,3,4,0,0,0,1\n", "trajectory");
    check(mark +
              "timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], "
              "q_RS_y [], q_RS_z []\n1,2,3,4,1,0,0,0\n",
          "trajectory");
    check(mark + "x,y,z,roll,pitch,yaw\n1,2,3,0,0,0\n", "trajectory");
    check(mark + "lat,lon,height\n52.1,4.2,3\n", "latitudes");
    check(mark + "Longitude Latitude Altitude\n4.1 52.2 3\n", "angles");
  }
  CHECK(points_of_columns("lat,lon,x,y,z\n52,4,1,-2.5,3e2\n52,4,4,5,6\n") == kTwoColumns);
}

TEST_CASE("what looks like something else than points is refused with what it looks like") {
  const auto check = [](const std::string& text, const std::string& what) {
    INFO(text.substr(0, 200));
    const Refusal refusal = refusal_of_columns(text);
    check_says(refusal.text, "line ... looks like ... " + what);
    CHECK(refusal.remedy == Remedy::kColumns);
    ScratchFolder scratch;
    try {
      read_model_points(scratch.write("model.txt", text));
      FAIL("read as a model");
    } catch (const InputError& error) {
      check_says(error.what(), std::string("looks like ... ") + what);
      CHECK(error.remedy() == Remedy::kNone);  // a model's columns cannot be chosen
    }
  };
  for (const int lines : {1, 2, 50, 300}) {
    check(table(lines, [](int i) { return matrix_line(i, false); }), "12 numbers");
    check(table(lines, [](int i) { return matrix_line(i, true); }), "16 numbers");
    check(table(lines, [](int i) { return std::to_string(7 * i) + " " + matrix_line(i, false); }),
          "13 numbers");
    check(table(lines, [](int i) { return matrix_line(i, true) + " 2"; }), "17 numbers");
  }
  for (const int lines : {2, 50, 300}) {
    check(table(lines, tum_line), "quaternion");
    check("# ground truth\n" + table(lines, tum_line), "quaternion");
  }
  check(table(9,
              [](int i) {
                return print("%g %g 2 0.3 0.4 %.6f %.6f", 0.5 * i, 0.2 * i,
                             std::sin(0.1 * i) * std::sqrt(0.75),
                             std::cos(0.1 * i) * std::sqrt(0.75));
              }),
        "7 numbers");
  for (const int lines : {3, 50, 300}) {
    for (const int first : {0, 1, 1001}) {
      check(table(lines,
                  [=](int i) {
                    return print("%d %.3f %.3f %.3f", first + i, 5.2 + 0.3 * i, 8.1, 2.7);
                  }),
            "number");
      check(table(lines,
                  [=](int i) {
                    return print("%d,%.3f,%.3f,%.3f,wall", first + i, 5.2 - 0.1 * i, 8.1, 2.7);
                  }),
            "number");
    }
  }
  check(
      table(20, [](int i) { return print("%.6f %.3f 8.1 2.7", 1623423423.25 + 0.1 * i, 0.3 * i); }),
      "time");
}

TEST_CASE("times and grid indices before the coordinates are recognised") {
  struct Row {
    const char* what;
    double first_column;
    std::function<std::string(int)> line;
  };
  const auto places = [](int i) {  // a beam that turns
    return print("%.3f %.3f %.3f", 5 * std::cos(0.07 * i), 5 * std::sin(0.07 * i), 0.3 + 0.01 * i);
  };
  const auto far = [](int i) {
    return print("%.3f %.3f %.3f", 5e5 + 0.7 * i * i, 5.4e6 - 0.3 * i * i, 101.0 + 0.1 * i);
  };
  const Row rows[] = {
      {"time", 2, [&](int i) { return print("%.6f ", 388721.25 + 1e-5 * i) + places(i); }},
      // Two returns of a beam have one time.
      {"time", 2, [&](int i) { return print("%.6f ", 388721.25 + 1e-3 * (i / 2)) + places(i); }},
      {"time", 2, [&](int i) { return print("%.3f ", 0.1 * i) + places(i) + " 7"; }},
      {"time", 2, [&](int i) { return print("%.2f ", 0.05 * i) + places(i) + " 7 8 9"; }},
      {"time", 2, [&](int i) { return print("%d ", 1000 + 50 * i) + places(i); }},
      {"time", 2, [&](int i) { return print("%d ", 1000 + 7 * i + i % 3) + places(i); }},
      // With as many digits as the coordinates and steps that differ, a map tells.
      {"time", 2, [&](int i) { return print("%.3f ", 12.0 + 0.01 * i * i) + far(i); }},
      {"row", 3, [&](int i) { return print("%d %d ", i / 7, i % 7) + places(i); }},
      {"row", 3, [&](int i) { return print("%d %d ", i % 7, i / 7) + places(i) + " 0.5"; }},
      {"row", 3, [&](int i) { return print("0 %d ", 3 * i) + places(i) + " 9 8 7"; }},
      {"row", 3, [&](int i) { return print("%d %d ", 1 + i / 5, 1 + 2 * (i % 5)) + far(i); }}};
  for (const Row& row : rows) {
    for (const int lines : {12, 100, 250}) {
      const std::string text = table(lines, row.line);
      INFO(text.substr(0, 200));
      const Refusal refusal = refusal_of_columns(text);
      check_says(refusal.text, std::string("line 1 ... ") + row.what);
      CHECK(refusal.remedy == Remedy::kColumns);
      CHECK(refusal.amount == row.first_column);
      const auto x = static_cast<int>(row.first_column);
      check_equal(
          points_of_columns(text, {std::to_string(x), std::to_string(x + 1), std::to_string(x + 2)})
              .size(),
          static_cast<std::size_t>(lines));
    }
  }
}

TEST_CASE("points that are sorted or lie in a grid are no times and no indices") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0, 1);
  const std::vector<std::function<std::string(int)>> layouts{
      // Profiles by ascending x: along an axis, across it, along a curve, with attributes.
      [&](int i) { return print("%.3f 5.250 %.3f %.3f", 0.05 * i, share(random), share(random)); },
      [&](int i) { return print("%.3f %.3f %.3f 0.5", 0.05 * i, 0.02 * i, share(random)); },
      [&](int i) { return print("%.3f %.3f %.3f 17", 0.05 * i, share(random), share(random)); },
      [&](int i) {
        return print("%.3f %.3f %.3f %.1f", 0.05 * i, share(random), share(random),
                     -9 * share(random));
      },
      [&](int i) {
        return print("%.3f %.3f %.3f %.3f", 0.05 * i + 0.03 * share(random), 9 * share(random),
                     share(random), share(random));
      },
      [&](int i) {
        return print("%.3f %.3f %.3f %d %d %d", 0.05 * i, share(random), share(random), i % 255, 7,
                     9);
      },
      [&](int i) {
        return print("%.3f %.3f %.3f %.3f %.3f 0.000", 0.05 * i, std::sin(0.1 * i), 1.0 * i,
                     std::cos(0.3 * i), std::sin(0.3 * i));
      },
      [&](int i) {
        return print("%.2f %.2f %.2f %.6f", 5e5 + 0.05 * i, 5.4e6 + share(random), share(random),
                     4e5 + 1e-5 * i);
      },
      [&](int i) { return print("%g %g %g", 0.5 * i, share(random), share(random)); },
      // Whole numbers, and heights above a grid of them.
      [&](int i) { return print("%d %d %d %d", i / 7, i % 7, i % 3, i % 5); },
      [&](int i) { return print("%d %d %.2f 1 2 3", i / 7, i % 7, share(random)); },
      [&](int i) { return print("%d %d %.2f %.2f", i / 7, i % 7, share(random), share(random)); },
      [&](int i) {
        return print("%d %d %.2f %.4f %.4f 0.0000", i / 7, i % 7, share(random), std::cos(0.3 * i),
                     std::sin(0.3 * i));
      },
      [&](int i) {
        return print("%d %d %.2f %.2f %.2f", i / 7, (5 * i) % 7, share(random), share(random),
                     share(random));
      }};
  for (std::size_t k = 0; k < layouts.size(); ++k) {
    for (const int lines : {12, 100, 250}) {
      INFO("layout " << k << ", " << lines << " lines");
      CHECK(refusal_of_columns(table(lines, layouts[k])).text.empty());
    }
  }
}

TEST_CASE("rows of scans in every usual layout pass") {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> metres(-30, 30);
  const auto direction = [&] {
    Vec3 n{normal(random), normal(random), normal(random)};
    const double length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    return Vec3{n.x / length, n.y / length, n.z / length};
  };
  const auto xyz = [&] {
    return print("%.3f %.3f %.3f", metres(random), metres(random), metres(random));
  };
  const auto colour = [&] {
    return print("%d %d %d", static_cast<int>(random() % 256), static_cast<int>(random() % 256),
                 static_cast<int>(random() % 256));
  };
  const auto unit = [&] {
    const Vec3 n = direction();
    return print("%.6f %.6f %.6f", n.x, n.y, n.z);
  };
  const std::vector<std::function<std::string(int)>> layouts{
      [&](int) { return xyz(); },
      [&](int) { return xyz() + " 0.5"; },
      [&](int) { return xyz() + " " + colour(); },
      [&](int) { return xyz() + " -1200 " + colour(); },
      [&](int) { return xyz() + " " + unit(); },
      [&](int) { return xyz() + " " + unit() + " 0"; },  // a normal and its curvature
      [&](int) { return xyz() + " 0 " + unit(); },       // a normal behind an intensity of 0
      [&](int) { return xyz() + " 0 " + unit() + " 0"; },
      [&](int) { return xyz() + " 0 " + unit() + " 0.01"; },
      [&](int) { return xyz() + " " + colour() + " " + unit(); },
      [&](int) { return xyz() + " 0 0 0 " + unit(); },  // black, and a normal
      [&](int) { return xyz() + " 12 " + colour() + " " + unit() + " 0.01 3"; },  // 12 numbers
      [&](int) { return xyz() + " " + xyz() + " " + unit() + " " + unit(); },
      [&](int) { return "0 0 0 " + unit() + " 0"; },
      [&](int i) { return print("%d 0 0 9", i); },  // a regular grid of points
      [&](int i) { return print("%d %d 0.5 9", i, i); },
      [&](int i) { return print("%.3f 0.000 1.25 9", 1.0 * i); },
      [&](int i) { return print("%g 4.1 101.25", 512345.5 + i); },
      [&](int i) { return print("%d %.2f %.2f", i, 0.1 * i, 5.5); },  // three columns
      [&](int i) { return print("%d %.2f %.2f 1 2 3", i / 2, 0.1 * i, 5.5); },
      [&](int i) {
        return print("%.3f %.3f 12.1 %d 1 %.4f", 512345.5 + 0.1 * i, 5412345.25, 1 + i % 3,
                     3e8 + i);
      },
      [&](int) { return std::string("1 0 0 0 0 1 0 0 0 0 0.9 0"); }};
  for (std::size_t k = 0; k < layouts.size(); ++k) {
    for (const int lines : {1, 2, 3, 10, 100, 250}) {
      INFO("layout " << k << ", " << lines << " lines");
      CHECK(refusal_of_columns(table(lines, layouts[k])).text.empty());
    }
  }
}

TEST_CASE("the caller chooses columns by numbers or by names") {
  CHECK(points_of_columns("9 1 -2.5 3e2\n9 4 5 6\n", {"2", "3", "4"}) == kTwoColumns);
  CHECK(points_of_columns("h;n;e\n3e2;-2.5;1\n6;5;4\n", {"3", "2", "1"}) == kTwoColumns);
  CHECK(points_of_columns("a,up,right\n1,3e2,-2.5\n4,6,5\n", {"A", "Right", "up"}) == kTwoColumns);
  CHECK(points_of_columns("# a up right\n1 3e2 -2.5\n4 6 5\n", {"a", "right", "up"}) ==
        kTwoColumns);
  CHECK(points_of_columns("2\nP1,1,-2.5,3e2\nP2,4,5,6\n", {"2", "3", "4"}) == kTwoColumns);
  // A table that would be refused is read where its columns are chosen.
  check_equal(points_of_columns(table(5, tum_line), {"2", "3", "4"}).size(), 5);
  check_equal(points_of_columns("1 1 -2.5 3e2\n2 4 5 6\n3 0 0 0\n", {"2", "3", "4"}).size(), 3);
  CHECK(points_of_columns("t,x,y,z,qx,qy,qz,qw\n1,1,-2.5,3e2,0,0,0,1\n2,4,5,6,0,0,0,1\n",
                          {"x", "y", "z"}) == kTwoColumns);
  const ReadCloud millimetres = cloud_of("X [mm],Y [mm],Z [mm]\n1,2,3\n", {"1", "2", "3"});
  REQUIRE(millimetres.info.remarks.size() == 1);
  check_equal(millimetres.info.remarks[0].code, "other-unit");
}

TEST_CASE("chosen columns that are not there are refused") {
  check_says(refusal_of_columns("1 2 3\n", {"2", "3", "4"}).text, "line 1");
  check_says(refusal_of_columns("1 2 3 4\n1 2 3\n", {"2", "3", "4"}).text,
             "line 2 ... columns 2 3 4");
  check_says(refusal_of_columns("a,b,c\n1,2,3\n", {"a", "b", "d"}).text, "a, b, d");
  check_says(refusal_of_columns("a,b,c,c\n1,2,3,4\n", {"a", "b", "c"}).text, "once");
  check_says(refusal_of_columns("1 2 3\n", {"a", "b", "c"}).text, "a, b, c");
  check_says(refusal_of_columns("9 1 x 3\n9 4 5 6\n", {"2", "3", "4"}).text, "line 1");
  check_says(refusal_of_columns("1 2 3\n", {"0", "1", "2"}).text, "0, 1, 2");
  ScratchFolder scratch;
  CHECK_THROWS_AS(open_point_file(scratch.write("a.xyz", "1 2 3\n"), {{"1", "2"}, true}),
                  UsageError);
}
