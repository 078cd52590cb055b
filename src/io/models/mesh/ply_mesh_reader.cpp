#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/models/mesh/mesh_builder.hpp"
#include "io/models/mesh/mesh_reader.hpp"
#include "io/scans/ply/ply_body.hpp"
#include "io/scans/stated_crs.hpp"

namespace clearway {
namespace {

/// What an element other than the vertices represents.
enum class Kind { kNothing, kFace, kStrip, kEdge };

struct Drawn {
  Kind kind = Kind::kNothing;
  std::optional<std::size_t> list = {};  ///< index of the property that lists the vertices
  std::size_t ends[2] = {};              ///< properties with the ends of an edge that has no list
};

/// The index of the first property of one of these names that is a list, or that is none.
std::optional<std::size_t> find_property(const PlyElement& element, bool list,
                                         std::initializer_list<std::string_view> names) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (property.list_count.has_value() != list) continue;
    for (const std::string_view name : names) {
      if (property.name == name) return i;
    }
  }
  return std::nullopt;
}

/// What an element draws. name: the file's, for messages.
Drawn drawn_by(const PlyElement& element, const std::string& name) {
  if (element.count == 0 || element.name == "vertex") return {};
  const auto list = find_property(element, true, {"vertex_indices", "vertex_index"});
  if (element.name == "edge") {
    const auto from = find_property(element, false, {"vertex1"});
    const auto to = find_property(element, false, {"vertex2"});
    if (!list && (!from || !to)) {
      refuse(name,
             "the element edge does not name its two vertices; expected the properties vertex1 and "
             "vertex2");
    }
    return {Kind::kEdge, list, {from.value_or(0), to.value_or(0)}};
  }
  const bool strips = element.name == "tristrips";
  if (!list && (strips || element.name == "face")) {
    refuse(name, "the element " + element.name +
                     " has no list vertex_indices or vertex_index; expected one of them");
  }
  return {!list ? Kind::kNothing : strips ? Kind::kStrip : Kind::kFace, list};
}

class PlyMeshParser {
 public:
  explicit PlyMeshParser(InputBuffer input) : body_(std::move(input)) {}

  MeshFile parse() {
    const PlyHeader& header = body_.header();
    if (header.unit) mesh_.set_unit(header.unit->file_unit());
    if (!find_drawn()) return mesh_.finish();
    if (!header.unplaced.empty()) {
      refuse(body_.input().name(), header.unplaced + std::string(kExpectedPlaced));
    }
    // Faces may stand before the vertices, which are read first in any case.
    const InputBuffer::Mark start = body_.input().mark();
    for (std::size_t i = 0; i < header.vertex; ++i) body_.skip(header.elements[i]);
    read_vertices();
    if (header.vertex > 0) {
      const InputBuffer::Mark behind = body_.input().mark();
      body_.input().return_to(start);
      for (std::size_t i = 0; i < header.vertex; ++i) draw_element(i);
      body_.input().return_to(behind);
    }
    for (std::size_t i = header.vertex + 1; i < header.elements.size(); ++i) draw_element(i);
    body_.check_end();
    return mesh_.finish();
  }

 private:
  /// Whether any element draws faces, strips or edges.
  bool find_drawn() {
    bool any = false;
    const PlyElement* faces = nullptr;
    for (const PlyElement& element : body_.header().elements) {
      const Kind kind = drawn_.emplace_back(drawn_by(element, body_.input().name())).kind;
      any = any || kind != Kind::kNothing;
      if (kind != Kind::kFace) continue;
      if (faces != nullptr) {
        refuse(body_.input().name(), "two elements with faces, " + faces->name + " and " +
                                         element.name + "; expected one");
      }
      faces = &element;
    }
    return any;
  }

  void read_vertices() {
    for (std::uint64_t row = 0; row < body_.vertices().count; ++row) {
      body_.read_row(body_.vertices(), row);
      mesh_.add_vertex(body_.vertex(), body_.row_place());
    }
    note_end(body_.vertices());
  }

  void draw_element(std::size_t index) {
    const PlyElement& element = body_.header().elements[index];
    const Drawn& drawn = drawn_[index];
    if (drawn.kind == Kind::kNothing) {
      body_.skip(element);
    } else {
      for (std::uint64_t row = 0; row < element.count; ++row) {
        body_.read_row(element, row, drawn.list);
        draw_row(drawn);
      }
    }
    note_end(element);
  }

  /// Notes whether the file ends within the last line of an element.
  void note_end(const PlyElement& element) {
    if (element.count > 0 && body_.ends_open()) mesh_.remarks().last_line_open = true;
  }

  void draw_row(const Drawn& drawn) {
    corners_.clear();
    if (drawn.list) {
      for (const double item : body_.items()) corners_.push_back(vertex_of(item, drawn.kind));
    } else {
      for (const std::size_t end : drawn.ends) {
        corners_.push_back(vertex_of(body_.numbers()[end], drawn.kind));
      }
    }
    if (drawn.kind == Kind::kFace) return mesh_.add_face(corners_, body_.row_place());
    if (drawn.kind == Kind::kEdge) return mesh_.add_line(corners_, body_.row_place());
    draw_strips();
  }

  /// The vertex index that a value holds. In strips, -1 is allowed and ends one strip and starts
  /// the next.
  std::int64_t vertex_of(double value, Kind kind) const {
    const bool ends_strip = kind == Kind::kStrip && value == -1;
    if (!ends_strip && !(value >= 0 && value < 0x1p32 && value == std::floor(value))) {
      mesh_.refuse_at(body_.row_place(), std::string(kind == Kind::kEdge ? "an edge" : "a face") +
                                             " names vertex " + format_number(value) +
                                             "; expected a whole number from 0");
    }
    return static_cast<std::int64_t>(value);
  }

  /// Draws strips of triangles, every other of which has the opposite orientation. Triangles with
  /// two equal vertices only connect parts of a strip and are not drawn.
  void draw_strips() {
    std::size_t first = 0;  // index of the strip's first vertex
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (corners_[i] == -1) first = i + 1;
      if (corners_[i] == -1 || i < first + 2) continue;
      std::int64_t a = corners_[i - 2], b = corners_[i - 1], c = corners_[i];
      if ((i - first) % 2 == 1) std::swap(a, b);
      if (a != b && b != c && c != a) mesh_.add_face(std::array{a, b, c}, body_.row_place());
    }
  }

  PlyBody body_;
  MeshBuilder mesh_{body_.input().name()};
  std::vector<Drawn> drawn_;           ///< one per element
  std::vector<std::int64_t> corners_;  ///< vertices of the current row
};

}  // namespace

MeshFile read_ply_mesh(InputBuffer input) { return PlyMeshParser(std::move(input)).parse(); }

}  // namespace clearway
