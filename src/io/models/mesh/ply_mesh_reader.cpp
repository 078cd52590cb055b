#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/util/format.hpp"
#include "io/files/bytes.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_number.hpp"
#include "io/models/mesh/mesh_builder.hpp"
#include "io/models/mesh/mesh_reader.hpp"
#include "io/scans/ply/ply_header.hpp"
#include "io/scans/text_copy.hpp"

namespace clearway {
namespace {

/// Reads the numbers of a PLY file's body one after the other.
class PlyNumbers {
 public:
  virtual ~PlyNumbers() = default;
  virtual void begin_row(const PlyElement& element, std::uint64_t row) = 0;
  virtual double next(PlyType type, const std::string& property) = 0;
  virtual void end_row() {}
  virtual FilePlace here() const = 0;  ///< position of the current row
  /// Whether anything follows the last row.
  virtual bool more() = 0;
};

class AsciiPlyNumbers final : public PlyNumbers {
 public:
  explicit AsciiPlyNumbers(InputBuffer& input) : input_(input) {}

  void begin_row(const PlyElement& element, std::uint64_t row) override {
    if (next_line()) return;
    refuse(input_.name(), "ends after line " + std::to_string(input_.line()) + " with " +
                              std::to_string(row) + " of element " + excerpt(element.name) +
                              "; expected " + std::to_string(element.count) + " of them");
  }

  double next(PlyType, const std::string& property) override {
    at_ = skip_blanks(at_, end_);
    double value = 0;
    if (!parse_number(at_, end_, value) || (at_ != end_ && !is_blank(*at_))) {
      refuse_line(input_.name(), input_.line(),
                  "expected a number for property " + excerpt(property));
    }
    return value;
  }

  void end_row() override {
    if (skip_blanks(at_, end_) == end_) return;
    refuse_line(input_.name(), input_.line(),
                "more than the element's properties; expected the end of the line");
  }

  FilePlace here() const override { return {"line", input_.line()}; }
  bool more() override { return next_line(); }

 private:
  bool next_line() {
    std::string_view line;
    do {
      if (!input_.next_line(line)) return false;
      at_ = line.data();
      end_ = at_ + line.size();
    } while (skip_blanks(at_, end_) == end_);
    return true;
  }

  InputBuffer& input_;
  const char* at_ = nullptr;
  const char* end_ = nullptr;
};

class BinaryPlyNumbers final : public PlyNumbers {
 public:
  BinaryPlyNumbers(InputBuffer& input, bool swapped) : input_(input), swapped_(swapped) {
    refuse_if_copied_as_text(input_);
    refuse_seven_bits(input_);
  }

  void begin_row(const PlyElement& element, std::uint64_t row) override {
    element_ = &element;
    row_ = row;
    start_ = input_.position();
  }

  double next(PlyType type, const std::string&) override {
    const auto bytes = input_.take(size_bytes(type));
    if (bytes.empty()) {
      refuse(input_.name(), "ends at byte " + std::to_string(input_.end_position()) + ", within " +
                                std::to_string(row_) + " of element " + excerpt(element_->name) +
                                "; expected " + std::to_string(element_->count) + " of them");
    }
    return number(type, bytes.data());
  }

  FilePlace here() const override { return {"byte", start_}; }
  bool more() override { return !input_.take(1).empty(); }

 private:
  template <typename Number>
  double as(const std::byte* bytes) const {
    return static_cast<double>(swapped_ ? load_swapped<Number>(bytes) : load<Number>(bytes));
  }

  double number(PlyType type, const std::byte* bytes) const {
    switch (type) {
      case PlyType::kInt8:
        return as<std::int8_t>(bytes);
      case PlyType::kUint8:
        return as<std::uint8_t>(bytes);
      case PlyType::kInt16:
        return as<std::int16_t>(bytes);
      case PlyType::kUint16:
        return as<std::uint16_t>(bytes);
      case PlyType::kInt32:
        return as<std::int32_t>(bytes);
      case PlyType::kUint32:
        return as<std::uint32_t>(bytes);
      case PlyType::kFloat32:
        return as<float>(bytes);
      case PlyType::kFloat64:
        break;
    }
    return as<double>(bytes);
  }

  InputBuffer& input_;
  bool swapped_;
  const PlyElement* element_ = nullptr;
  std::uint64_t row_ = 0, start_ = 0;
};

/// Lists of vertex indices that were read before the vertices and so cannot be checked yet.
template <typename Kind>
class PendingLists {
 public:
  void add(Kind kind, std::span<const std::int64_t> vertices, const FilePlace& at) {
    lists_.push_back({kind, vertices.size(), at});
    vertices_.insert(vertices_.end(), vertices.begin(), vertices.end());
  }

  /// Calls use(kind, vertices, at) for each list.
  template <typename Use>
  void use_all(Use use) {
    const std::int64_t* next = vertices_.data();
    for (const auto& [kind, size, at] : lists_) {
      use(kind, std::span(next, size), at);
      next += size;
    }
    lists_ = {};
    vertices_ = {};
  }

 private:
  struct List {
    Kind kind;
    std::size_t size;
    FilePlace at;
  };

  std::vector<List> lists_;
  std::vector<std::int64_t> vertices_;
};

class PlyMeshParser {
 public:
  PlyMeshParser(InputBuffer& input, PlyHeader header)
      : input_(input), header_(std::move(header)), mesh_(input.name()) {}

  MeshFile parse() {
    if (!find_drawn()) return {};
    if (header_.format == PlyFormat::kAscii) {
      AsciiPlyNumbers numbers(input_);
      read_body(numbers);
    } else {
      BinaryPlyNumbers numbers(input_, header_.format == PlyFormat::kBigEndian);
      read_body(numbers);
    }
    return mesh_.finish();
  }

 private:
  /// What an element other than the vertices represents.
  enum class Kind { kNothing, kFace, kStrip, kEdge };

  struct Drawn {
    Kind kind = Kind::kNothing;
    std::optional<std::size_t> list;  ///< index of the property that lists the vertices
    /// Properties with the ends of an edge that has no list.
    std::optional<std::size_t> ends[2] = {{}, {}};
  };

  /// Whether any element draws faces, strips or edges.
  bool find_drawn() {
    bool any = false;
    const PlyElement* faces = nullptr;
    for (const PlyElement& element : header_.elements) {
      drawn_.push_back(element.count == 0 ? Drawn{} : drawn_by(element));
      any = any || drawn_.back().kind != Kind::kNothing;
      if (drawn_.back().kind != Kind::kFace) continue;
      if (faces != nullptr) {
        refuse(input_.name(), "two elements with faces, " + faces->name + " and " + element.name +
                                  "; expected one");
      }
      faces = &element;
    }
    return any;
  }

  Drawn drawn_by(const PlyElement& element) const {
    Drawn drawn{.list = list_of(element)};
    if (element.name == "vertex") return {};
    if (element.name == "edge") {
      drawn.kind = Kind::kEdge;
      if (!drawn.list) find_ends(element, drawn);
      return drawn;
    }
    const bool strips = element.name == "tristrips";
    if (!drawn.list && (strips || element.name == "face")) {
      refuse(input_.name(), "the element " + element.name +
                                " has no list vertex_indices or vertex_index; expected one of "
                                "them");
    }
    if (drawn.list) drawn.kind = strips ? Kind::kStrip : Kind::kFace;
    return drawn;
  }

  /// Index of the property that lists the vertices of an element; nullopt where there is none.
  static std::optional<std::size_t> list_of(const PlyElement& element) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if ((property.name == "vertex_indices" || property.name == "vertex_index") &&
          property.list_count) {
        return i;
      }
    }
    return std::nullopt;
  }

  void find_ends(const PlyElement& edge, Drawn& drawn) const {
    for (std::size_t i = 0; i < edge.properties.size(); ++i) {
      const PlyProperty& property = edge.properties[i];
      if (property.list_count) continue;
      if (property.name == "vertex1") drawn.ends[0] = i;
      if (property.name == "vertex2") drawn.ends[1] = i;
    }
    if (drawn.ends[0] && drawn.ends[1]) return;
    refuse(input_.name(),
           "the element edge does not name its two vertices; expected the properties vertex1 and "
           "vertex2");
  }

  void read_body(PlyNumbers& numbers) {
    for (std::size_t i = 0; i < header_.elements.size(); ++i) {
      const PlyElement& element = header_.elements[i];
      for (std::uint64_t row = 0; row < element.count; ++row) {
        numbers.begin_row(element, row);
        if (i == header_.vertex) {
          read_vertex(numbers, element);
        } else {
          read_other(numbers, element, drawn_[i]);
          if (drawn_[i].kind != Kind::kNothing) keep(drawn_[i].kind, i, numbers.here());
        }
        numbers.end_row();
      }
      if (i != header_.vertex) continue;
      pending_.use_all([this](Kind kind, std::span<const std::int64_t> vertices,
                              const FilePlace& at) { draw(kind, vertices, at); });
    }
    mesh_.remarks().last_line_open =
        header_.format == PlyFormat::kAscii && !input_.line_terminated();
    if (numbers.more()) {
      mesh_.refuse_at(numbers.here(), "more than the header declares; expected the file's end");
    }
  }

  void read_vertex(PlyNumbers& numbers, const PlyElement& element) {
    Vec3 vertex{};
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (property.list_count) {
        skip_list(numbers, property);
        continue;
      }
      const double value = numbers.next(property.type, property.name);
      for (int axis = 0; axis < 3; ++axis) {
        if (header_.coordinates[axis] == i) vertex[axis] = value;
      }
    }
    mesh_.add_vertex(vertex, numbers.here());
  }

  void read_other(PlyNumbers& numbers, const PlyElement& element, const Drawn& drawn) {
    corners_.clear();
    std::int64_t ends[2] = {};
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (drawn.list == i) {
        read_corners(numbers, property, drawn.kind);
      } else if (property.list_count) {
        skip_list(numbers, property);
      } else {
        const double value = numbers.next(property.type, property.name);
        for (int end = 0; end < 2; ++end) {
          if (drawn.ends[end] == i) ends[end] = vertex_of(value, drawn.kind, numbers);
        }
      }
    }
    if (drawn.kind == Kind::kEdge && !drawn.list) corners_.assign({ends[0], ends[1]});
  }

  std::uint64_t list_size(PlyNumbers& numbers, const PlyProperty& property) {
    const double count = numbers.next(*property.list_count, property.name);
    if (!(count >= 0 && count <= 0xFFFFFFFFp0 && count == std::floor(count))) {
      mesh_.refuse_at(numbers.here(), "a list of " + format_number(count) +
                                          " items; expected a whole number from 0");
    }
    return static_cast<std::uint64_t>(count);
  }

  void skip_list(PlyNumbers& numbers, const PlyProperty& property) {
    const std::uint64_t count = list_size(numbers, property);
    for (std::uint64_t i = 0; i < count; ++i) numbers.next(property.type, property.name);
  }

  void read_corners(PlyNumbers& numbers, const PlyProperty& property, Kind kind) {
    const std::uint64_t count = list_size(numbers, property);
    for (std::uint64_t i = 0; i < count; ++i) {
      corners_.push_back(vertex_of(numbers.next(property.type, property.name), kind, numbers));
    }
  }

  /// The vertex index that a value holds. In strips, -1 is allowed and ends one strip and starts
  /// the next.
  std::int64_t vertex_of(double value, Kind kind, const PlyNumbers& numbers) const {
    const bool ends_strip = kind == Kind::kStrip && value == -1;
    if (!ends_strip && !(value >= 0 && value < 0x1p32 && value == std::floor(value))) {
      mesh_.refuse_at(numbers.here(), std::string(kind == Kind::kEdge ? "an edge" : "a face") +
                                          " names vertex " + format_number(value) +
                                          "; expected a whole number from 0");
    }
    return static_cast<std::int64_t>(value);
  }

  /// Draws the row that was read, or keeps it until the vertices have been read. element: its
  /// index.
  void keep(Kind kind, std::size_t element, const FilePlace& at) {
    if (element > header_.vertex) return draw(kind, corners_, at);
    pending_.add(kind, corners_, at);
  }

  void draw(Kind kind, std::span<const std::int64_t> vertices, const FilePlace& at) {
    if (kind == Kind::kFace) return mesh_.add_face(vertices, at);
    if (kind == Kind::kEdge) return mesh_.add_line(vertices, at);
    draw_strips(vertices, at);
  }

  /// Draws strips of triangles, every other of which has the opposite orientation. Triangles with
  /// two equal vertices only connect parts of a strip and are not drawn.
  void draw_strips(std::span<const std::int64_t> vertices, const FilePlace& at) {
    std::size_t first = 0;  // index of the strip's first vertex
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (vertices[i] == -1) first = i + 1;
      if (vertices[i] == -1 || i < first + 2) continue;
      std::int64_t a = vertices[i - 2], b = vertices[i - 1], c = vertices[i];
      if ((i - first) % 2 == 1) std::swap(a, b);
      if (a != b && b != c && c != a) mesh_.add_face(std::array{a, b, c}, at);
    }
  }

  InputBuffer& input_;
  PlyHeader header_;
  MeshBuilder mesh_;
  std::vector<Drawn> drawn_;  ///< one per element
  PendingLists<Kind> pending_;
  std::vector<std::int64_t> corners_;  ///< vertices of the current row
};

}  // namespace

MeshFile read_ply_mesh(InputBuffer input) {
  PlyHeader header = read_ply_header(input);
  const FileUnit unit = header.unit ? header.unit->file_unit() : FileUnit();
  MeshFile out = PlyMeshParser(input, std::move(header)).parse();
  out.unit = unit;
  return out;
}

}  // namespace clearway
