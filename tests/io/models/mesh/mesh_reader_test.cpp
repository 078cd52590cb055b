#include "io/models/mesh/mesh_reader.hpp"

#include <catch2/catch.hpp>

#include "support/bytes/mesh_bytes.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

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
  const ReaderScratch scratch;
  const auto path = scratch.write(name, bytes);
  try {
    read(path);
  } catch (const InputError& error) {
    CHECK_THAT(error.what(), Contains(path.string()));
    return error.what();
  }
  return {};
}

MeshFile read(const std::string& name, const std::string& bytes) {
  const ReaderScratch scratch;
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
    CHECK(file.mesh.vertices.size() == 8);
    CHECK(file.remarks.polygons == 0);
    CHECK_FALSE(file.remarks.last_line_open);
  }
}

TEST_CASE("STL text may differ in case, name several solids and lack names") {
  const std::string facet =
      "FACET NORMAL nan nan nan\nOuter Loop\nVERTEX 0 0 0\nvertex 1e0 0 -0\r\nvertex 0 1 0\n"
      "ENDLOOP\nendfacet\n";
  const MeshFile file =
      read("a.stl", "\n solid\n" + facet + "endsolid\n\nSOLID b\n" + facet + "end solid b");
  CHECK(file.mesh.triangles.size() == 2);
  CHECK(file.mesh.vertices.size() == 3);
}

TEST_CASE("STL that is cut, lies or holds what it cannot is refused") {
  const std::string binary = binary_stl(unit_cube());
  CHECK_THAT(refusal("a.stl", binary.substr(0, 600)),
             Contains("byte 80") && Contains("12 triangles") && Contains("684 bytes"));
  const std::string longer = refusal("a.stl", binary + "more");
  CHECK_THAT(longer, Contains("byte 80") && Contains("688") && Contains("4 bytes more") &&
                         !Contains("cut"));
  CHECK_THAT(refusal("a.stl", "short"), Contains("84 or more"));
  CHECK_THAT(refusal("a.stl", ""), Contains("84 or more"));
  std::string nan = binary;
  nan.replace(84 + 50 + 12, 4, std::string("\0\0\xC0\x7F", 4));
  CHECK_THAT(refusal("a.stl", nan), Contains("byte 134") && Contains("finite"));
  const std::string text = ascii_stl(unit_cube());
  CHECK_THAT(refusal("a.stl", text.substr(0, text.size() - 14)), Contains("may be cut"));
  CHECK_THAT(refusal("a.stl", "solid\nfacet\nouter loop\nvertex 0 0\n"),
             Contains("line 4") && Contains("vertex X Y Z"));
  CHECK_THAT(refusal("a.stl",
                     "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 "
                     "0\nvertex 0 1 0\n"),
             Contains("line 7") && Contains("three vertices"));
}

TEST_CASE("OBJ counts forwards, backwards and with textures and normals") {
  const MeshFile file = read("a.obj",
                             "# made\nmtllib a.mtl\no one\ng\ns off\nv 0 0 0\nv 1 0 0 0.5\n"
                             "v 1 1 0 0.1 0.2 0.3\nvt 0 0\nvn 0 0 1\nusemtl red # f 1 2 3\n"
                             "f 1/1/1 2//1 \\\n  3/1\nv 0 1 0\nf -4 -2 -1\nl 1 2\np 1\n"
                             "f 1 2 3 4");
  CHECK(file.mesh.vertices.size() == 4);
  REQUIRE(file.mesh.triangles.size() == 6);
  CHECK(file.mesh.triangles[0] == Triple{0, 1, 2});
  CHECK(file.mesh.triangles[1] == Triple{0, 2, 3});
  CHECK(file.mesh.triangles[2] == Triple{0, 1, 1});
  CHECK(file.mesh.triangles[3] == Triple{0, 0, 0});
  CHECK(file.remarks.polygons == 1);
  CHECK(file.remarks.segments == 1);
  CHECK(file.remarks.single_points == 1);
  CHECK(file.remarks.last_line_open);
}

TEST_CASE("lines and points of OBJ belong to the mesh as triangles without area") {
  const MeshFile file = read("a.obj",
                             "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1/1 2/2 3\nv 0 1 0\nl -2 -1\n"
                             "p 1 -1\n");
  CHECK(file.mesh.triangles ==
        std::vector<Triple>{{0, 1, 1}, {1, 2, 2}, {2, 3, 3}, {0, 0, 0}, {3, 3, 3}});
  CHECK(file.remarks.segments == 3);
  CHECK(file.remarks.single_points == 2);
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
    CHECK_THAT(refusal("a.obj", start + line + "\n"), Contains("line 4") && Contains(message));
  }
  CHECK_THAT(refusal("a.obj", start + "f 1 2 \\"), Contains("line 4") && Contains("file's end"));
  CHECK_THAT(refusal("a.obj", ""), Contains("empty"));
}

TEST_CASE("OFF may have comments, colours, normals and its counts beside its name") {
  const std::string cube =
      "4 1 9 # counts\n\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n1 1 0 9 9 9 9 # third\n"
      "0 1 0 1 1 1 1\n4 0 1 2 3 255 0 0";
  for (const std::string start : {"COFF\n# c\n", "NOFF ", "OFF", "\n  OFF\n", "STCNOFF\n", ""}) {
    INFO(start);
    const MeshFile file = read("a.off", start + cube);
    CHECK(file.mesh.vertices.size() == 4);
    CHECK(file.mesh.triangles.size() == 2);
    CHECK(file.remarks.last_line_open);
  }
}

TEST_CASE("faces of OFF with one or two corners are points and lines") {
  const MeshFile file = read("a.off", "OFF\n3 3 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n2 0 2\n1 1\n");
  CHECK(file.mesh.triangles == std::vector<Triple>{{0, 1, 2}, {0, 2, 2}, {1, 1, 1}});
  CHECK_THAT(refusal("a.off", "OFF\n1 1 0\n0 0 0\n0\n"), Contains("0 corners"));
}

TEST_CASE("OFF that lies or is of another kind is refused") {
  CHECK_THAT(refusal("a.off", "OFF BINARY\n"), Contains("binary OFF"));
  CHECK_THAT(refusal("a.off", "4OFF\n1 0 0\n0 0 0 1\n"), Contains("line 1"));
  CHECK_THAT(refusal("a.off", "OFF\n2 0 0\n0 0 0\n"), Contains("vertex 1 of 2"));
  CHECK_THAT(refusal("a.off", "OFF\n1 0 0\n0 0 0\n1 1 1\n"), Contains("line 4: more than"));
  CHECK_THAT(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 3\n"),
             Contains("line 6") && Contains("vertex 3"));
  CHECK_THAT(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1\n"), Contains("line 6"));
  CHECK_THAT(refusal("a.off", "OFF\n18446744073709551615 1 0\n0 0 0\n"), Contains("ends after"));
  CHECK_THAT(refusal("a.off", "OFF\n-1 1 0\n"), Contains("line 2"));
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
  CHECK(behind.remarks.segments == 2);
  const MeshFile before = ply(faces + edges + vertices, "3 0 1 2\n2 3 9\n3 0 9\n" + points);
  CHECK(before.mesh.triangles == expected);
  CHECK(before.mesh.vertices == behind.mesh.vertices);
  CHECK(ply(edges + vertices, "2 3 9\n3 0 9\n" + points).mesh.triangles.size() == 2);
  const std::string lines = "element edge 1\nproperty list uchar int vertex_indices\n";
  CHECK(ply(vertices + lines, points + "3 0 1 2\n").mesh.triangles ==
        std::vector<Triple>{{0, 1, 1}, {1, 2, 2}});
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\n";
  CHECK(ply(vertices + strips, points + "8 0 1 2 3 -1 3 1 0\n").mesh.triangles ==
        std::vector<Triple>{{0, 1, 2}, {2, 1, 3}, {3, 1, 0}});
  CHECK(ply(vertices + strips, points + "5 0 1 2 2 3\n").mesh.triangles ==
        std::vector<Triple>{{0, 1, 2}});  // the other two only continue the strip
  const std::string start = "ply\nformat ascii 1.0\n";
  CHECK_THAT(refusal("a.ply", start + faces + vertices + "end_header\n3 0 1 4\n" + points),
             Contains("line 10") && Contains("a face names vertex 4"));
  CHECK_THAT(refusal("a.ply", start + edges + vertices + "end_header\n0 4 1\n0 1 1\n" + points),
             Contains("line 12") && Contains("a line names vertex 4"));
  CHECK_THAT(refusal("a.ply", start + vertices + edges + "end_header\n" + points + "0 -1 1\n"),
             Contains("an edge names vertex -1"));
  CHECK_THAT(refusal("a.ply", start + vertices + "element edge 1\nproperty int a\nend_header\n"),
             Contains("vertex1 and vertex2"));
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
  CHECK(file.mesh.triangles.size() == 1);
  CHECK(file.remarks.last_line_open);
  CHECK_THAT(refusal("a.ply", ply(vertex + "element face 1\nproperty int a\nend_header\n")),
             Contains("vertex_indices"));
  CHECK(read("a.ply",
             ply(vertex + "element polygon 1\n" + list + "end_header\n" + points + "3 0 1 2\n"))
            .mesh.triangles.size() == 1);
  CHECK_THAT(refusal("a.ply", ply(vertex + "element face 1\n" + list + "element faces 1\n" + list +
                                  "end_header\n")),
             Contains("two elements with faces, face and faces"));
  const std::string whole = vertex + "element face 1\n" + list + "end_header\n" + points;
  for (const std::string face : {"3 0 1 3\n", "3 0 1 -1\n", "3 0 1 1.5\n", "2 0 1\n"}) {
    CHECK_THAT(refusal("a.ply", ply(whole + face)), Contains("line 13"));
  }
  CHECK_THAT(refusal("a.ply", ply(whole + "3 0 1 2\n1 2 3\n")), Contains("more than the header"));
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
  CHECK_THAT(refusal("a.ply", ply), Contains("expected at most 1,000,000"));
}

TEST_CASE("meshes and drawings of other formats are refused by name") {
  for (const std::string name : {"a.gltf", "a.glb", "a.dae", "a.ifc", "a.STEP", "a.fbx", "a.dxf"}) {
    CHECK_THAT(refusal(name, "any text"), Contains("Export the model as STL, OBJ or PLY"));
  }
  CHECK_THAT(refusal("a.dat", "ISO-10303-21;\n"), Contains("STEP"));
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
    CHECK_THAT(message, Contains(row.what) && !Contains("cut"));
  }
}

TEST_CASE("a cut mesh that declares its size is refused at every byte") {
  const TriangleMesh cube = unit_cube();
  const auto every_cut = [](const std::string& name, const std::string& bytes, std::size_t least) {
    const ReaderScratch scratch;
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
