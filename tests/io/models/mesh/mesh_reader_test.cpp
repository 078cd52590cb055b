#include "io/models/mesh/mesh_reader.hpp"

#include <cmath>

#include "io/models/mesh/mesh_builder.hpp"
#include "support/bytes/mesh_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"
#include "support/triangle_distance.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Triple = std::array<std::uint32_t, 3>;

MeshFile read(const std::filesystem::path& path) {
  File file = File::open_for_reading(path);
  const auto format = mesh_format_of(file, path);
  REQUIRE(format);
  return read_mesh(InputBuffer(std::move(file), InputBuffer::Access::kSeek), *format);
}

/// The message with which the file is refused; empty where it is read.
std::string refusal(const std::string& name, const std::string& bytes) {
  const ScratchFolder scratch;
  const auto path = scratch.write(name, bytes);
  try {
    read(path);
  } catch (const InputError& error) {
    check_says(error.what(), path.string());
    return error.what();
  }
  return {};
}

MeshFile read(const std::string& name, const std::string& bytes) {
  const ScratchFolder scratch;
  return read(scratch.write(name, bytes));
}

/// Whether the triangles of two meshes lie at the same places in the same order.
bool same_places(const TriangleMesh& a, const TriangleMesh& b) {
  if (a.triangles.size() != b.triangles.size()) return false;
  for (std::size_t i = 0; i < a.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (a.vertices[a.triangles[i][k]] != b.vertices[b.triangles[i][k]]) return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("every mesh format gives the same triangles") {
  const TriangleMesh cube = unit_cube();
  const std::pair<const char*, std::string> files[] = {
      {"a.stl", ascii_stl(cube)},
      {"a.stl", binary_stl(cube)},
      {"A.STL", binary_stl(cube, "solid made by a program")},
      {"a.obj", obj_text(cube)},
      {"a.off", off_text(cube)},
      {"a.dat", off_text(cube)},
      {"a.ply", ply_mesh(cube, "ascii")},
      {"a.bin", ply_mesh(cube, "binary_little_endian")}};
  for (const auto& [name, bytes] : files) {
    INFO(name << " " << bytes.substr(0, 20));
    const MeshFile file = read(name, bytes);
    CHECK(same_places(file.mesh, cube));
    check_equal(file.mesh.vertices.size(), 8);
    check_equal(file.remarks.polygons, 0);
    CHECK_FALSE(file.remarks.last_line_open);
  }
}

TEST_CASE("STL text may differ in case, name several solids and lack names") {
  const std::string facet =
      "FACET NORMAL nan nan nan\nOuter Loop\nVERTEX 0 0 0\nvertex 1e0 0 -0\r\nvertex 0 1 0\n"
      "ENDLOOP\nendfacet\n";
  const MeshFile file =
      read("a.stl", "\n solid\n" + facet + "endsolid\n\nSOLID b\n" + facet + "end solid b");
  check_equal(file.mesh.triangles.size(), 2);
  check_equal(file.mesh.vertices.size(), 3);
}

TEST_CASE("STL that is cut, lies or holds what it cannot is refused") {
  const std::string binary = binary_stl(unit_cube());
  check_says(refusal("a.stl", binary.substr(0, 600)), "byte 80 ... 12 triangles ... 684 bytes");
  const std::string longer = refusal("a.stl", binary + "more");
  check_says(longer, "byte 80 ... 688 ... 4 bytes more");
  check_lacks(longer, "cut");
  check_says(refusal("a.stl", "short"), "84 or more");
  check_says(refusal("a.stl", ""), "84 or more");
  std::string nan = binary;
  nan.replace(84 + 50 + 12, 4, std::string("\0\0\xC0\x7F", 4));
  check_says(refusal("a.stl", nan), "byte 134 ... finite");
  const std::string text = ascii_stl(unit_cube());
  check_says(refusal("a.stl", text.substr(0, text.size() - 14)), "may be cut");
  check_says(refusal("a.stl", "solid\nfacet\nouter loop\nvertex 0 0\n"), "line 4 ... vertex X Y Z");
  check_says(refusal("a.stl",
                     "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 "
                     "0\nvertex 0 1 0\n"),
             "line 7 ... three vertices");
}

TEST_CASE("OBJ counts forwards, backwards and with textures and normals") {
  const MeshFile file = read("a.obj",
                             "# made\nmtllib a.mtl\no one\ng\ns off\nv 0 0 0\nv 1 0 0 0.5\n"
                             "v 1 1 0 0.1 0.2 0.3\nvt 0 0\nvn 0 0 1\nusemtl red # f 1 2 3\n"
                             "f 1/1/1 2//1 \\\n  3/1\nv 0 1 0\nf -4 -2 -1\nl 1 2\np 1\n"
                             "f 1 2 3 4");
  check_equal(file.mesh.vertices.size(), 4);
  REQUIRE(file.mesh.triangles.size() == 6);
  CHECK(file.mesh.triangles[0] == Triple{0, 1, 2});
  CHECK(file.mesh.triangles[1] == Triple{0, 2, 3});
  CHECK(file.mesh.triangles[2] == Triple{0, 1, 1});
  CHECK(file.mesh.triangles[3] == Triple{0, 0, 0});
  check_equal(file.remarks.polygons, 1);
  check_equal(file.remarks.segments, 1);
  check_equal(file.remarks.single_points, 1);
  CHECK(file.remarks.last_line_open);
}

TEST_CASE("lines and points of OBJ belong to the mesh as triangles without area") {
  const MeshFile file = read("a.obj",
                             "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1/1 2/2 3\nv 0 1 0\nl -2 -1\n"
                             "p 1 -1\n");
  CHECK(file.mesh.triangles ==
        std::vector<Triple>{{0, 1, 1}, {1, 2, 2}, {2, 3, 3}, {0, 0, 0}, {3, 3, 3}});
  check_equal(file.remarks.segments, 3);
  check_equal(file.remarks.single_points, 2);
}

TEST_CASE("OBJ that cannot be a mesh is refused with its line") {
  const std::string start = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  const std::pair<std::string, std::string> wrong[] = {
      {"f 1 2 4", "names vertex 4; expected 1 to 3"},
      {"f 1 2 0", "names vertex 0"},
      {"f 1 2 -4", "names vertex -4"},
      {"f 1 2", "2 corners"},
      {"l 1", "a line through 1 vertex; expected 2 or more"},
      {"l 1 4", "a line names vertex 4; expected 1 to 3"},
      {"p 0", "a point names vertex 0"},
      {"p", "a point without a vertex"},
      {"f 1 2 3x", "corner \"3x\""},
      {"f 1 2 99999999999999999999", "corner"},
      {"v 1 2", "expected `v X Y Z`"},
      {"v 1 2 nan", "finite"},
      {"v 1 2 1e999", "expected `v X Y Z`"},
      {"surf 0 1 0 1 1 2 3", "is not read"},
      {"call other.obj", "is not read"},
      {"hello", "expected an OBJ statement"}};
  for (const auto& [line, message] : wrong) {
    INFO(line);
    check_says(refusal("a.obj", start + line + "\n"), std::string("line 4 ... ") + message);
  }
  check_says(refusal("a.obj", start + "f 1 2 \\"), "line 4 ... file's end");
  check_says(refusal("a.obj", ""), "empty");
}

TEST_CASE("OFF may have comments, colours, normals and its counts beside its name") {
  const std::string cube =
      "4 1 9 # counts\n\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n1 1 0 9 9 9 9 # third\n"
      "0 1 0 1 1 1 1\n4 0 1 2 3 255 0 0";
  for (const std::string start : {"COFF\n# c\n", "NOFF ", "OFF", "\n  OFF\n", "STCNOFF\n", ""}) {
    INFO(start);
    const MeshFile file = read("a.off", start + cube);
    check_equal(file.mesh.vertices.size(), 4);
    check_equal(file.mesh.triangles.size(), 2);
    CHECK(file.remarks.last_line_open);
  }
}

TEST_CASE("faces of OFF with one or two corners are points and lines") {
  const MeshFile file = read("a.off", "OFF\n3 3 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n2 0 2\n1 1\n");
  CHECK(file.mesh.triangles == std::vector<Triple>{{0, 1, 2}, {0, 2, 2}, {1, 1, 1}});
  check_says(refusal("a.off", "OFF\n1 1 0\n0 0 0\n0\n"), "0 corners");
}

TEST_CASE("OFF that lies or is of another kind is refused") {
  check_says(refusal("a.off", "OFF BINARY\n"), "binary OFF");
  check_says(refusal("a.off", "4OFF\n1 0 0\n0 0 0 1\n"), "line 1");
  check_says(refusal("a.off", "OFF\n2 0 0\n0 0 0\n"), "vertex 1 of 2");
  check_says(refusal("a.off", "OFF\n1 0 0\n0 0 0\n1 1 1\n"), "line 4: more than");
  check_says(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 3\n"), "line 6 ... vertex 3");
  check_says(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1\n"), "line 6");
  check_says(refusal("a.off", "OFF\n18446744073709551615 1 0\n0 0 0\n"), "ends after");
  check_says(refusal("a.off", "OFF\n-1 1 0\n"), "line 2");
}

TEST_CASE("edges and strips of PLY belong to the mesh, wherever its elements stand") {
  const std::string vertices =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string edges =
      "element edge 2\nproperty int vertex1\nproperty int vertex2\nproperty uchar crease\n";
  const std::string points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const auto ply = [](const std::string& elements, const std::string& body) {
    return read("a.ply", "ply\nformat ascii 1.0\n" + elements + "end_header\n" + body);
  };
  const std::vector<Triple> expected{{0, 1, 2}, {2, 3, 3}, {3, 0, 0}};
  const MeshFile behind = ply(vertices + faces + edges, points + "3 0 1 2\n2 3 9\n3 0 9\n");
  CHECK(behind.mesh.triangles == expected);
  check_equal(behind.remarks.segments, 2);
  const MeshFile before = ply(faces + edges + vertices, "3 0 1 2\n2 3 9\n3 0 9\n" + points);
  CHECK(before.mesh.triangles == expected);
  CHECK(before.mesh.vertices == behind.mesh.vertices);
  check_equal(ply(edges + vertices, "2 3 9\n3 0 9\n" + points).mesh.triangles.size(), 2);
  const std::string lines = "element edge 1\nproperty list uchar int vertex_indices\n";
  CHECK(ply(vertices + lines, points + "3 0 1 2\n").mesh.triangles ==
        std::vector<Triple>{{0, 1, 1}, {1, 2, 2}});
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\n";
  CHECK(ply(vertices + strips, points + "8 0 1 2 3 -1 3 1 0\n").mesh.triangles ==
        std::vector<Triple>{{0, 1, 2}, {2, 1, 3}, {3, 1, 0}});
  CHECK(ply(vertices + strips, points + "5 0 1 2 2 3\n").mesh.triangles ==
        std::vector<Triple>{{0, 1, 2}});  // the other two only continue the strip
  const std::string start = "ply\nformat ascii 1.0\n";
  check_says(refusal("a.ply", start + faces + vertices + "end_header\n3 0 1 4\n" + points),
             "line 10 ... a face names vertex 4");
  check_says(refusal("a.ply", start + edges + vertices + "end_header\n0 4 1\n0 1 1\n" + points),
             "line 12 ... a line names vertex 4");
  check_says(refusal("a.ply", start + vertices + edges + "end_header\n" + points + "0 -1 1\n"),
             "an edge names vertex -1");
  check_says(refusal("a.ply", start + vertices + "element edge 1\nproperty int a\nend_header\n"),
             "vertex1 and vertex2");
}

TEST_CASE("binary PLY with its faces before its vertices is the same mesh") {
  const TriangleMesh cube = unit_cube();
  const std::string bytes = ply_mesh(cube, "binary_little_endian");
  const std::size_t body = bytes.find("end_header\n") + 11, faces = body + 8 * 24;
  std::string turned =
      "ply\nformat binary_little_endian 1.0\nelement face 12\n"
      "property list uchar int vertex_indices\nelement vertex 8\n"
      "property double x\nproperty double y\nproperty double z\nend_header\n";
  turned += bytes.substr(faces) + bytes.substr(body, faces - body);
  const MeshFile file = read("a.ply", turned);
  CHECK(file.mesh.triangles == cube.triangles);
  CHECK(file.mesh.vertices == cube.vertices);
}

TEST_CASE("PLY faces need their list and indices that exist") {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string vertex = "element vertex 3\n" + xyz;
  const std::string list = "property list uchar int vertex_index\n";
  const std::string points = "0 0 0\n1 0 0\n1 1 0\n";
  const auto ply = [](const std::string& rest) { return "ply\nformat ascii 1.0\n" + rest; };
  const MeshFile file =
      read("a.ply", ply(vertex + "element face 1\nproperty uchar red\n" + list +
                        "property list uchar float uv\nelement other 1\nproperty int a\n"
                        "end_header\n" +
                        points + "7 3 0 1 2 2 0.5 0.5\n9"));
  check_equal(file.mesh.triangles.size(), 1);
  CHECK(file.remarks.last_line_open);
  check_says(refusal("a.ply", ply(vertex + "element face 1\nproperty int a\nend_header\n")),
             "vertex_indices");
  check_equal(read("a.ply", ply(vertex + "element polygon 1\n" + list + "end_header\n" + points +
                                "3 0 1 2\n"))
                  .mesh.triangles.size(),
              1);
  check_says(refusal("a.ply", ply(vertex + "element face 1\n" + list + "element faces 1\n" + list +
                                  "end_header\n")),
             "two elements with faces, face and faces");
  const std::string whole = vertex + "element face 1\n" + list + "end_header\n" + points;
  for (const std::string face : {"3 0 1 3\n", "3 0 1 -1\n", "3 0 1 1.5\n", "2 0 1\n"}) {
    check_says(refusal("a.ply", ply(whole + face)), "line 13");
  }
  check_says(refusal("a.ply", ply(whole + "3 0 1 2\n1 2 3\n")), "more than the header");
}

TEST_CASE("a face with more corners than any model has is refused before it is cut") {
  constexpr std::uint32_t kCorners = 1'000'001;
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty double x\n"
      "property double y\nproperty double z\nelement face 1\n"
      "property list uint uchar vertex_index\nend_header\n";
  ply.append(3 * sizeof(double), '\0');
  ply.append(reinterpret_cast<const char*>(&kCorners), sizeof kCorners);
  ply.append(kCorners, '\0');
  check_says(refusal("a.ply", ply), "expected at most 1,000,000");
}

TEST_CASE("meshes and drawings of other formats are refused by name") {
  for (const std::string name : {"a.gltf", "a.glb", "a.dae", "a.ifc", "a.STEP", "a.fbx", "a.dxf"}) {
    check_says(refusal(name, "any text"), "Export the model as STL, OBJ or PLY");
  }
  check_says(refusal("a.dat", "ISO-10303-21;\n"), "STEP");
}

TEST_CASE("a mesh that is longer than it declares is refused as longer") {
  const TriangleMesh cube = unit_cube();
  struct Row {
    std::string name, bytes, what;
  };
  const Row rows[] = {
      {"a.stl", binary_stl(cube) + std::string(50, 't'), "50 bytes more"},
      {"a.stl", ascii_stl(cube) + "more\n", "expected `solid NAME`"},
      {"a.off", off_text(cube) + "3 0 1 2\n", "more than the 8 vertices"},
      {"a.ply", ply_mesh(cube, "ascii") + "3 0 1 2\n", "more than"},
      {"a.ply", ply_mesh(cube, "binary_little_endian") + "more", "more than the header declares"}};
  for (const Row& row : rows) {
    INFO(row.bytes.substr(0, 30));
    const std::string message = refusal(row.name, row.bytes);
    check_says(message, row.what);
    check_lacks(message, "cut");
  }
}

TEST_CASE("a cut mesh that declares its size is refused at every byte") {
  const TriangleMesh cube = unit_cube();
  const auto every_cut = [](const std::string& name, const std::string& bytes, std::size_t least) {
    const ScratchFolder scratch;
    const auto path = scratch.write(name, bytes);
    for (std::size_t size = bytes.size() - 1; size > least; --size) {
      std::filesystem::resize_file(path, size);
      INFO(name << " cut to " << size);
      CHECK_THROWS_AS(read(path), InputError);
    }
  };
  every_cut("a.stl", binary_stl(cube), 0);
  every_cut("a.stl", ascii_stl(cube).substr(0, ascii_stl(cube).size() - 6), 6);
  every_cut("a.ply", ply_mesh(cube, "binary_little_endian"), 3);
  // The last line may lack its break, so the last digit is all that a cut can hide.
  const std::string off = off_text(cube);
  every_cut("a.off", off.substr(0, off.size() - 1), 3);
}

namespace {

double area_of(const std::vector<Vec3>& corners, const CutPolygon& cut) {
  double area = 0;
  for (const auto& [a, b, c] : cut.triangles) {
    const Vec3 normal = cross(minus(corners[b], corners[a]), minus(corners[c], corners[a]));
    area += std::sqrt(dot(normal, normal)) / 2;
  }
  return area;
}

/// Whether a place lies in one of the polygon's triangles.
bool covers(const std::vector<Vec3>& corners, const CutPolygon& cut, const Vec3& place) {
  for (const auto& [a, b, c] : cut.triangles) {
    if (triangle_distance(place, corners[a], corners[b], corners[c]) < 1e-12) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("a convex polygon is cut as a fan") {
  std::vector<Vec3> corners;
  for (int i = 0; i < 100; ++i) corners.push_back({std::cos(i * 0.0628), 5, std::sin(i * 0.0628)});
  const CutPolygon cut = cut_polygon(corners);
  check_equal(cut.triangles.size(), 98);
  CHECK(is_fan(corners));
  CHECK(cut.bend < 1e-12);
  CHECK(area_of(corners, cut) == Approx(3.1390).epsilon(1e-3));
}

TEST_CASE("a polygon that is not convex keeps its notch, whatever corner comes first") {
  // The polygon is an L in the tilted plane z = x + y.
  const std::vector<Vec3> shape{{0, 0, 0}, {3, 0, 3}, {3, 1, 4}, {1, 1, 2}, {1, 3, 4}, {0, 3, 3}};
  for (std::size_t first = 0; first < shape.size(); ++first) {
    for (const bool turned : {false, true}) {
      std::vector<Vec3> corners;
      for (std::size_t i = 0; i < shape.size(); ++i) corners.push_back(shape[(first + i) % 6]);
      if (turned) std::reverse(corners.begin(), corners.end());
      const CutPolygon cut = cut_polygon(corners);
      CHECK_FALSE(cut.crossing);
      check_equal(cut.triangles.size(), 4);
      CHECK(area_of(corners, cut) == Approx(5 * std::sqrt(3.0)));
      CHECK(covers(corners, cut, {2.9, 0.5, 3.4}));
      CHECK_FALSE(covers(corners, cut, {2, 2, 4}));
    }
  }
}

TEST_CASE("an outline with a hole on a bridge keeps its hole") {
  const std::vector<Vec3> corners{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                                  {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
  const CutPolygon cut = cut_polygon(corners);
  CHECK_FALSE(cut.crossing);
  CHECK(area_of(corners, cut) == Approx(12));
  CHECK_FALSE(covers(corners, cut, {2, 2, 0}));
  CHECK(covers(corners, cut, {3.5, 2, 0}));
}

TEST_CASE("a bent polygon says by how much, a crossing one that it crosses") {
  const std::vector<Vec3> bent{{0, 0, 0}, {1, 0, 0.1}, {1, 1, 0}, {0, 1, 0.1}};
  CHECK(cut_polygon(bent).bend == Approx(0.05));
  const std::vector<Vec3> bow{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 1, 0}, {1, 3, 0}, {0, 3, 0}};
  const CutPolygon cut = cut_polygon(bow);
  CHECK(cut.crossing);
  check_equal(cut.triangles.size(), 4);
}

TEST_CASE("polygons without area are cut without harm") {
  const std::vector<Vec3> line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  check_equal(cut_polygon(line).triangles.size(), 2);
  check_equal(cut_polygon(std::vector<Vec3>(5, Vec3{1, 2, 3})).triangles.size(), 3);
  const std::vector<Vec3> huge{{1e300, 0, 0}, {0, 1e300, 0}, {0, 0, 1e300}, {1e300, 1, 1}};
  check_equal(cut_polygon(huge).triangles.size(), 2);
}
