// A file in a binary format, or a text that declares its points: whole, cut, damaged, and copied as
// text. The files of tests/formats are damaged too, and E57 with right checksums in e57_scans_test.
#include <random>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "support/bytes/e57_bytes.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/bytes/mesh_bytes.hpp"
#include "support/bytes/pcd_bytes.hpp"
#include "support/bytes/sbet_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Files = std::vector<std::pair<std::string, std::string>>;
using Quanta = std::vector<std::array<std::int32_t, 3>>;

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFace = "element face 1\nproperty list uchar int n\n";

std::string ply(const std::string& format, const std::string& elements, const std::string& body) {
  return "ply\nformat " + format + " 1.0\n" + elements + "end_header\n" + body;
}

/// The same points as a file of every binary format. scale: of the quanta.
Files binary_files(const Quanta& quanta, double scale) {
  LasBytes las;
  las.scale = {scale, scale, scale};
  las.offset = {0, 0, 0};
  las.points = quanta;
  LazBytes laz = laz_bytes(1, quanta.size());
  laz.las.scale = las.scale;
  laz.las.offset = las.offset;
  std::array<std::vector<double>, 3> axes;
  std::string floats, with_more, columns;
  TriangleMesh mesh{{}, {{0, 1, 2}}};
  for (std::size_t i = 0; i < quanta.size(); ++i) {
    laz.points[i].position = quanta[i];
    with_more += 'a';
    Vec3& p = mesh.vertices.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      axes[axis].push_back(p[static_cast<int>(axis)] = quanta[i][axis] * scale);
      floats += raw(static_cast<float>(axes[axis].back()));
    }
    with_more += floats.substr(floats.size() - 12);
  }
  for (const auto& axis : axes) {
    for (const double number : axis) columns += raw(static_cast<float>(number));
  }
  E57Bytes e57;
  e57.scans = {e57_scan(axes[0], axes[1], axes[2])};
  for (std::size_t i = 1; i < quanta.size() / 2000; ++i) {
    e57.scans[0].packets.push_back({16000, 16000, 16000});
  }
  PcdHeaderText pcd;
  pcd.width = pcd.points = std::to_string(quanta.size());
  const std::string vertices = "element vertex " + pcd.points + "\n";
  Files files{
      {"a.las", las.build()},
      {"a.laz", laz.build()},
      {"a.e57", e57.build()},
      {"a.ply", ply("binary_little_endian", vertices + kXyz, floats)},
      {"b.ply", ply("binary_little_endian", vertices + "property uchar a\n" + kXyz, with_more)},
      {"c.ply", ply_mesh(mesh, "binary_little_endian")},
      {"a.pcd", pcd.build("binary") + floats},
      {"b.pcd", pcd.build("binary_compressed") + compressed(columns)}};
  las.extra_bytes = 3;
  files.emplace_back("b.las", las.build());
  return files;
}

/// Requires that the whole file is read, and that it is refused when cut at any byte, except within
/// its last `spare` bytes, without which it has the same number of points.
void check_every_cut(const std::string& name, const std::string& bytes, std::size_t spare = 0,
                     bool as_stream = false) {
  const RowName row(name + (as_stream ? " as a stream: " : ": ") + bytes.substr(0, 300));
  const ScratchFolder scratch;
  const auto path = scratch.write(name, bytes);
  for (std::size_t size = bytes.size() + 1; size-- > 0;) {
    std::filesystem::resize_file(path, size);
    const std::string message = as_stream ? stream_refusal_of(path) : refusal_of(path);
    if (size + spare >= bytes.size()) {
      check_equal(message, "");
    } else if (message.find(path.string()) == std::string::npos) {
      FAIL("not refused when cut to " << size << " of " << bytes.size() << " bytes");
    }
  }
}

/// Reads a file in every way that its name allows; anything but an Error fails the test.
void read_anything(const std::filesystem::path& path) {
  const auto attempt = [](auto read) {
    try {
      read();
    } catch (const Error&) {
    }
  };
  attempt([&] { read_all(path); });
  attempt([&] { read_model_points(path); });
  attempt([&] { read_stream(path); });
  for (const auto format : {TrajectoryFormat::kAuto, TrajectoryFormat::kCsv}) {
    attempt([&] { read_trajectory(path, {format, true}); });
  }
}

std::string exchanged(std::string bytes, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = bytes.find(what, at)) != bytes.npos; at += by.size()) {
    bytes.replace(at, what.size(), by);
  }
  return bytes;
}

}  // namespace

TEST_CASE("the points of many batches arrive in their order, twice") {
  Quanta quanta;
  for (std::int32_t i = 0; i < 70'001; ++i) quanta.push_back({i, -i, 2 * i});
  const ScratchFolder scratch;
  for (const auto& [name, bytes] : binary_files(quanta, 1)) {
    INFO(name);
    const auto reader = open_point_file(scratch.write(name, bytes));
    for (int pass = 0; pass < 2; ++pass) {
      const ReadCloud cloud = read_all(*reader);
      REQUIRE(cloud.size() == quanta.size());
      for (std::size_t i = 0; i < quanta.size(); ++i) {
        const auto& [x, y, z] = quanta[i];
        if (cloud.at(i) != Vec3{1.0 * x, 1.0 * y, 1.0 * z}) FAIL("point " << i);
      }
      reader->rewind();
    }
  }
}

TEST_CASE("a cut LAS file is refused at every byte, and so is a cut stream") {
  std::vector<LasBytes> files = las_samples();
  files.emplace_back(files[4]).points.clear();
  for (const LasBytes& las : files) {
    for (const bool as_stream : {false, true}) check_every_cut("a.las", las.build(), 0, as_stream);
  }
}

TEST_CASE("a cut binary file is refused at every byte") {
  E57Bytes e57;
  e57.page = 128;
  e57.scans = {e57_scan({1, 2}, {3, 4}, {5, 6}), e57_scan({}, {}, {})};
  check_every_cut("a.e57", e57.build());
  const std::string rows = raw(1.F, 2.F, 3.F, 4.F, 5.F, 6.F);
  check_every_cut("a.pcd", PcdHeaderText().build("binary") + rows);
  check_every_cut("a.pcd", PcdHeaderText().build("binary_compressed") + compressed(rows));
  for (const std::string format : {"binary_little_endian", "binary_big_endian"}) {
    const std::string vertices(36, 'v'), three = "element vertex 3\n" + kXyz;
    check_every_cut("a.ply", ply(format, three, vertices));
    check_every_cut("a.ply", ply(format, "element vertex 0\n" + kXyz, ""));
    // The list has 0x0101 = 257 two-byte items in either byte order.
    const std::string list = "\1\1" + std::string(514, 'i');
    const std::string property = "property list ushort short a\n";
    check_every_cut("a.ply",
                    ply(format, "element a 1\n" + property + "element vertex 1\n" + kXyz + property,
                        list + std::string(12, 'v') + list));
    // Elements behind the vertices are not read.
    check_every_cut("a.ply", ply(format, three + kFace, vertices + std::string(9, 'f')), 9);
  }
}

// A text that lacks its last line break is read where all values of its last line are present,
// because missing digits of the last number cannot be noticed.
TEST_CASE("a cut text that declares its points is refused at every byte before its last number") {
  const std::string two = "element a 1\nproperty list uchar int n\nelement vertex 2\n" + kXyz;
  const std::string rows = "1.25 2.25 3.25\n4.25 5.25 625\n";
  check_every_cut("a.ply", ply("ascii", two, "2 10 11\n" + rows), 3);
  check_every_cut("a.ply", ply("ascii", two + kFace, "2 10 11\n" + rows + "3 10 11 12\n"), 11);
  check_every_cut("a.pcd", PcdHeaderText().build("ascii") + rows, 3);
  std::string pts = "12\n";
  for (int i = 0; i < 12; ++i) pts += "1.25 2.25 3.25 100 200 255\n";
  check_every_cut("a.pts", pts, 3);
  const std::string matrix = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  check_every_cut("a.ptx",
                  "3\n2\n" + matrix + "1.25 2.25 3.25 0.5\n0 0 0 0.5\n" +
                      "1 2 3 0.5\n1 2 3 0.5\n1 2 3 0.5\n1 2 3 975\n",
                  3);
}

TEST_CASE("flipped bytes and shuffled ends never do worse than a refusal") {
  LasBytes las{.minor = 4, .format = 6};
  las.vlrs = {{"LASF_Projection", 34735, std::string("\1\0\1\0\0\0\1\0\0\4\0\0\1\0\1\0", 16)},
              {"LASF_Projection", 2112, "PROJCS[\"a\",GEOGCS[\"b\"],UNIT[\"metre\",1]]"}};
  las.evlrs = {{"LASF_Projection", 2112, "LOCAL_CS[\"b\"]"}};
  Files files = binary_files({{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, 1);
  files.insert(files.end(),
               {{"a.las", las.build()},
                {"b.laz", laz_bytes(7, 40).build()},
                {"a.stl", binary_stl(unit_cube())},
                {"a.csv", "t,x,y,z,qx,qy,qz,qw\n1,2,3,4,0,0,0,1\n"},
                {"b.csv", "x[mm],y[mm],z[mm],roll_deg,pitch_deg,heading_deg\n1,2,3,4,5,6\n"},
                {"a.sbet", SbetRecord().bytes() + SbetRecord().bytes()},
                {"a.pose", "1 2 3\n10 20 30\n"},
                {"a.frames", "1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1 2\n"},
                {"a.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n"}});
  const ScratchFolder scratch;
  std::mt19937 random(1);
  for (const auto& [name, sample] : files) {
    for (int round = 0; round < 300; ++round) {
      std::string bytes = sample;
      for (auto flips = 1 + random() % 4; flips > 0; --flips) {
        bytes[random() % bytes.size()] = static_cast<char>(random() % 3 ? random() : 0xFF);
      }
      if (random() % 8 == 0) bytes.resize(random() % bytes.size());
      CHECK_NOTHROW(read_anything(scratch.write(name, bytes)));
    }
  }
}

TEST_CASE("binary files that were copied as text are refused, and the reason is given") {
  const ScratchFolder scratch;
  std::mt19937 random(1);
  Quanta quanta(2000);
  for (auto& q : quanta) {
    for (auto& c : q) c = static_cast<std::int32_t>(random() % 4'000'000) - 2'000'000;
  }
  for (const auto& [name, bytes] : binary_files(quanta, 0.001)) {
    INFO(name);
    REQUIRE(refusal_of(scratch.write(name, bytes)).empty());
    const std::string more = exchanged(bytes, "\n", "\r\n");
    const std::string fewer = exchanged(exchanged(bytes, "\r\n", "\n"), "\r", "");
    std::string low = bytes;
    for (char& c : low) c = static_cast<char>(c & 0x7F);
    REQUIRE(more.size() > bytes.size());
    check_says(refusal_of(scratch.write(name, more)), name + ": was copied as text");
    const bool is_e57 = name.ends_with("e57");  // whose header says so: 49,152 is 0xC000
    check_says(refusal_of(scratch.write(name, low)),
               is_e57 ? "has 49152 bytes; expected 16384" : "no byte above 127");
    CHECK_FALSE(refusal_of(scratch.write(name, fewer)).empty());
    for (const std::string& damaged : {more, low, fewer}) {
      const auto path = scratch.write(name, damaged);
      if (name.ends_with("ply") && damaged != fewer) {
        CHECK_THROWS_AS(read_model_points(path), InputError);
      }
      if (name.ends_with(".las") || name.ends_with(".laz")) {
        CHECK_FALSE(stream_refusal_of(path).empty());
      }
    }
  }
}

TEST_CASE("as many bytes as some records, put in by a copy as text, are never read as points") {
  LasBytes las;
  las.scale = {0.001, 0.001, 0.001};
  las.points.assign(500, {1'000'000, 2'000'000, 3'000'000});
  for (std::size_t i = 0; i < 40; ++i) las.points[12 * i] = {10, 0, 0};  // a line feed in each
  ScratchFolder scratch;
  const auto path = scratch.write("a.las", exchanged(las.build(), "\n", "\r\n"));
  CHECK(std::filesystem::file_size(path) == las.build().size() + 2 * las.record_bytes());
  for (const std::string& refusal : {refusal_of(path), stream_refusal_of(path)}) {
    check_says(refusal, "was copied as text");
  }
}

TEST_CASE("line ends of a header and few bytes say nothing of a copy as text") {
  ScratchFolder scratch;
  const std::string ply =
      "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 2\r\nproperty int x\r\n"
      "property int y\r\nproperty int z\r\nend_header\r\n";
  CHECK(read_all(scratch.write("a.ply", ply + raw(1, 2, 3, 4, 5, 6))).size() == 2);
  CHECK(read_all(scratch.write("b.ply", ply + raw(1, 2, 3, 4, 10, 13))).size() == 2);
}
