// Meshes as files of every format, and how polygons are cut; files of a few lines, and what is
// wrong with them, are in tests/formats/mesh.case.
#include "io/models/mesh/mesh_reader.hpp"

#include <cmath>

#include "support/bytes/mesh_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scratch_folder.hpp"
#include "support/triangle_distance.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Corners = std::vector<Vec3>;

MeshFile read(const std::filesystem::path& path) {
  File file = File::open_for_reading(path);
  const auto format = mesh_format_of(file, path);
  REQUIRE(format);
  return read_mesh(InputBuffer(std::move(file), InputBuffer::Access::kSeek), *format);
}

double area_of(const Corners& corners, const CutPolygon& cut) {
  double area = 0;
  for (const auto& [a, b, c] : cut.triangles) {
    const Vec3 normal = cross(minus(corners[b], corners[a]), minus(corners[c], corners[a]));
    area += std::sqrt(dot(normal, normal)) / 2;
  }
  return area;
}

/// Whether a place lies in one of the polygon's triangles.
bool covers(const Corners& corners, const CutPolygon& cut, const Vec3& place) {
  return std::ranges::any_of(cut.triangles, [&](const auto& triangle) {
    const auto& [a, b, c] = triangle;
    return triangle_distance(place, corners[a], corners[b], corners[c]) < 1e-12;
  });
}

}  // namespace

TEST_CASE("every mesh format gives the same triangles") {
  const TriangleMesh cube = unit_cube();
  const std::string ply = ply_mesh(cube, "binary_little_endian");
  const std::size_t body = ply.find("end_header\n") + 11, faces = body + 8 * 24;
  const std::string faces_first =
      "ply\nformat binary_little_endian 1.0\nelement face 12\n"
      "property list uchar int vertex_indices\nelement vertex 8\n"
      "property double x\nproperty double y\nproperty double z\nend_header\n";
  const std::pair<const char*, std::string> files[] = {
      {"a.stl", ascii_stl(cube)},
      {"a.stl", binary_stl(cube)},
      {"A.STL", binary_stl(cube, "solid made by a program")},
      {"a.obj", obj_text(cube)},
      {"a.off", off_text(cube)},
      {"a.dat", off_text(cube)},
      {"a.ply", ply_mesh(cube, "ascii")},
      {"a.bin", ply},
      {"a.ply", faces_first + ply.substr(faces) + ply.substr(body, faces - body)}};
  const ScratchFolder scratch;
  for (const auto& [name, bytes] : files) {
    INFO(name << " " << bytes.substr(0, 20));
    const MeshFile file = read(scratch.write(name, bytes));
    check_equal(file.mesh.vertices.size(), 8);
    check_equal(file.remarks.polygons, 0);
    CHECK_FALSE(file.remarks.last_line_open);
    REQUIRE(file.mesh.triangles.size() == cube.triangles.size());
    for (std::size_t i = 0; i < 36; ++i) {
      CHECK(file.mesh.vertices[file.mesh.triangles[i / 3][i % 3]] ==
            cube.vertices[cube.triangles[i / 3][i % 3]]);
    }
  }
}

TEST_CASE("a face with more corners than any model has is refused before it is cut") {
  constexpr std::uint32_t kCorners = 1'000'001;
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty double x\n"
      "property double y\nproperty double z\nelement face 1\n"
      "property list uint uchar vertex_index\nend_header\n" +
      std::string(3 * sizeof(double), '\0');
  put(ply, kCorners);
  const ScratchFolder scratch;
  check_refused([&] { read(scratch.write("a.ply", ply + std::string(kCorners, '\0'))); },
                "expected at most 1,000,000");
}

TEST_CASE("a mesh that is longer than it declares is refused as longer") {
  const TriangleMesh cube = unit_cube();
  const std::tuple<const char*, std::string, const char*> rows[] = {
      {"a.stl", binary_stl(cube) + std::string(50, 't'), "50 bytes more"},
      {"a.stl", ascii_stl(cube) + "more\n", "expected `solid NAME`"},
      {"a.off", off_text(cube) + "3 0 1 2\n", "more than the 8 vertices"},
      {"a.ply", ply_mesh(cube, "ascii") + "3 0 1 2\n", "more than"},
      {"a.ply", ply_mesh(cube, "binary_little_endian") + "more", "more than the header declares"}};
  const ScratchFolder scratch;
  for (const auto& [name, bytes, words] : rows) {
    try {
      read(scratch.write(name, bytes));
      FAIL("nothing was refused");
    } catch (const InputError& error) {
      check_says(error.what(), words);
      check_lacks(error.what(), "cut");
    }
  }
}

TEST_CASE("a cut mesh that declares its size is refused at every byte") {
  const TriangleMesh cube = unit_cube();
  // The last line may lack its break, so the last digit is all that a cut can hide.
  const std::string stl = ascii_stl(cube), off = off_text(cube);
  const std::tuple<const char*, std::string, std::size_t> rows[] = {
      {"a.stl", binary_stl(cube), 0},
      {"a.stl", stl.substr(0, stl.size() - 6), 6},
      {"a.ply", ply_mesh(cube, "binary_little_endian"), 3},
      {"a.off", off.substr(0, off.size() - 1), 3}};
  const ScratchFolder scratch;
  for (const auto& [name, bytes, least] : rows) {
    const auto path = scratch.write(name, bytes);
    for (std::size_t size = bytes.size() - 1; size > least; --size) {
      std::filesystem::resize_file(path, size);
      INFO(name << " cut to " << size);
      CHECK_THROWS_AS(read(path), InputError);
    }
  }
}

TEST_CASE("a convex polygon is cut as a fan") {
  Corners corners;
  for (int i = 0; i < 100; ++i) corners.push_back({std::cos(i * 0.0628), 5, std::sin(i * 0.0628)});
  const CutPolygon cut = cut_polygon(corners);
  check_equal(cut.triangles.size(), 98);
  CHECK(is_fan(corners));
  CHECK(cut.bend < 1e-12);
  check_near(area_of(corners, cut), 3.139, 3e-3);
}

TEST_CASE("a polygon that is not convex keeps its notch, whatever corner comes first") {
  // The polygon is an L in the tilted plane z = x + y.
  Corners corners{{0, 0, 0}, {3, 0, 3}, {3, 1, 4}, {1, 1, 2}, {1, 3, 4}, {0, 3, 3}};
  for (int turn = 0; turn < 12; ++turn) {
    std::ranges::rotate(corners, corners.begin() + 1);
    if (turn == 6) std::ranges::reverse(corners);
    const CutPolygon cut = cut_polygon(corners);
    CHECK_FALSE(cut.crossing);
    check_equal(cut.triangles.size(), 4);
    check_near(area_of(corners, cut), 5 * std::sqrt(3.0), 1e-12);
    CHECK(covers(corners, cut, {2.9, 0.5, 3.4}));
    CHECK_FALSE(covers(corners, cut, {2, 2, 4}));
  }
}

TEST_CASE("an outline with a hole on a bridge keeps its hole") {
  const Corners corners{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                        {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
  const CutPolygon cut = cut_polygon(corners);
  CHECK_FALSE(cut.crossing);
  check_near(area_of(corners, cut), 12, 1e-12);
  CHECK_FALSE(covers(corners, cut, {2, 2, 0}));
  CHECK(covers(corners, cut, {3.5, 2, 0}));
}

TEST_CASE("a bent polygon says by how much, a crossing one that it crosses") {
  const Corners bent{{0, 0, 0}, {1, 0, 0.1}, {1, 1, 0}, {0, 1, 0.1}};
  check_near(cut_polygon(bent).bend, 0.05, 1e-12);
  const Corners bow{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 1, 0}, {1, 3, 0}, {0, 3, 0}};
  const CutPolygon cut = cut_polygon(bow);
  CHECK(cut.crossing);
  check_equal(cut.triangles.size(), 4);
}

TEST_CASE("polygons without area are cut without harm") {
  for (const Corners& corners :
       {Corners{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}, Corners(5, Vec3{1, 2, 3}),
        Corners{{1e300, 0, 0}, {0, 1e300, 0}, {0, 0, 1e300}, {1e300, 1, 1}}}) {
    check_equal(cut_polygon(corners).triangles.size(), corners.size() - 2);
  }
}
