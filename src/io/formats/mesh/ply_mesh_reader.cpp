#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/formats/byte_load.hpp"
#include "io/formats/mesh/mesh_builder.hpp"
#include "io/formats/mesh/mesh_reader.hpp"
#include "io/formats/ply/ply_header.hpp"
#include "io/formats/text/text_number.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

/// The numbers of a PLY file's body, one after the other.
class PlyNumbers {
 public:
  virtual ~PlyNumbers() = default;
  virtual void begin_row(const PlyElement& element, std::uint64_t row) = 0;
  virtual double next(PlyType type, const std::string& property) = 0;
  virtual void end_row() {}
  virtual FilePlace here() const = 0;  ///< of the row
  /// Whether anything stands behind the last row.
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
  BinaryPlyNumbers(InputBuffer& input, bool swapped) : input_(input), swapped_(swapped) {}

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

class PlyMeshParser {
 public:
  PlyMeshParser(InputBuffer& input, PlyHeader header)
      : input_(input), header_(std::move(header)), mesh_(input.name()) {}

  MeshFile parse() {
    find_faces();
    if (face_ == header_.elements.size()) return {};
    find_corners(header_.elements[face_]);
    if (face_ < header_.vertex) {
      refuse(input_.name(), "faces before the vertices; expected them behind");
    }
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
  /// face_: the element of the faces; the number of elements where there are none.
  void find_faces() {
    face_ = header_.elements.size();
    for (std::size_t i = 0; i < header_.elements.size(); ++i) {
      const PlyElement& element = header_.elements[i];
      if (element.count == 0) continue;
      if (element.name == "tristrips") {
        refuse(input_.name(),
               "triangle strips are not read; expected the element face. Export the mesh with "
               "faces");
      }
      if (element.name != "face" && !corners_of(element)) continue;
      if (face_ != header_.elements.size()) {
        refuse(input_.name(), "two elements with faces, " + header_.elements[face_].name + " and " +
                                  element.name + "; expected one");
      }
      face_ = i;
    }
  }

  /// The property that lists the corners of faces; none where the element has none.
  static std::optional<std::size_t> corners_of(const PlyElement& element) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if ((property.name == "vertex_indices" || property.name == "vertex_index") &&
          property.list_count) {
        return i;
      }
    }
    return std::nullopt;
  }

  void find_corners(const PlyElement& face) {
    const auto found = corners_of(face);
    if (!found) {
      refuse(input_.name(),
             "the element face has no list vertex_indices or vertex_index; expected one of them");
    }
    corners_at_ = *found;
  }

  void read_body(PlyNumbers& numbers) {
    for (std::size_t i = 0; i < header_.elements.size(); ++i) {
      const PlyElement& element = header_.elements[i];
      const bool vertex = i == header_.vertex;
      for (std::uint64_t row = 0; row < element.count; ++row) {
        numbers.begin_row(element, row);
        if (vertex) {
          read_vertex(numbers, element);
        } else {
          read_other(numbers, element, i == face_);
        }
        numbers.end_row();
      }
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

  void read_other(PlyNumbers& numbers, const PlyElement& element, bool face) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (!property.list_count) {
        numbers.next(property.type, property.name);
      } else if (face && i == corners_at_) {
        read_corners(numbers, property);
      } else {
        skip_list(numbers, property);
      }
    }
    if (face) mesh_.add_face(corners_, numbers.here());
  }

  std::uint64_t list_size(PlyNumbers& numbers, const PlyProperty& property) {
    const double count = numbers.next(*property.list_count, property.name);
    if (!(count >= 0 && count <= 0xFFFFFFFFp0 && count == std::floor(count))) {
      mesh_.refuse_at(numbers.here(),
                      "a list of " + shown(count) + " items; expected a whole number from 0");
    }
    return static_cast<std::uint64_t>(count);
  }

  void skip_list(PlyNumbers& numbers, const PlyProperty& property) {
    const std::uint64_t count = list_size(numbers, property);
    for (std::uint64_t i = 0; i < count; ++i) numbers.next(property.type, property.name);
  }

  void read_corners(PlyNumbers& numbers, const PlyProperty& property) {
    corners_.clear();
    const std::uint64_t count = list_size(numbers, property);
    for (std::uint64_t i = 0; i < count; ++i) {
      const double corner = numbers.next(property.type, property.name);
      if (!(corner >= 0 && corner < 0x1p32 && corner == std::floor(corner))) {
        mesh_.refuse_at(numbers.here(), "a face names vertex " + shown(corner) +
                                            "; expected a whole number from 0");
      }
      corners_.push_back(static_cast<std::int64_t>(corner));
    }
  }

  InputBuffer& input_;
  PlyHeader header_;
  MeshBuilder mesh_;
  std::size_t face_ = 0;        ///< element
  std::size_t corners_at_ = 0;  ///< property of the element face
  std::vector<std::int64_t> corners_;
};

}  // namespace

MeshFile read_ply_mesh(InputBuffer input) {
  PlyHeader header = read_ply_header(input);
  return PlyMeshParser(input, std::move(header)).parse();
}

}  // namespace clearway
