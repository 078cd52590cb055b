#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "io/formats/ply/ply_body_reader.hpp"
#include "io/formats/ply/ply_reader.hpp"
#include "io/formats/text/point_blocks.hpp"
#include "io/formats/text/point_line.hpp"
#include "io/formats/text/text_number.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

class AsciiPlyReader final : public PlyBodyReader {
 public:
  AsciiPlyReader(InputBuffer input, PlyHeader header)
      : PlyBodyReader(std::move(input), std::move(header)) {
    begin();
  }

  bool read(PointBatch& batch) override {
    batch.quanta.clear();
    batch.positions.clear();
    const PlyElement& vertices = header_.vertices();
    const std::uint64_t stop = std::min<std::uint64_t>(vertices.count, next_ + kBatchPoints);
    while (next_ < stop) {
      const std::size_t taken =
          blocks_.take(batch.positions, batch.positions.size() + stop - next_);
      next_ += taken;
      if (taken > 0 || read_blocks()) continue;
      Vec3 point{};
      read_row(vertices, next_++, &point);
      batch.positions.push_back(point);
    }
    if (batch.positions.empty()) check_end();
    return !batch.positions.empty();
  }

  void rewind() override {
    PlyBodyReader::rewind();
    blocks_.clear();
    in_turn_ = 0;
  }

  std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> points) override {
    rewind();
    return lines_of_points(points, input_, [this] {
      if (next_ == header_.vertices().count) return false;
      next_row(header_.vertices(), next_++);
      return true;
    });
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    refuse_line(input_.name(), input_.line(), what);
  }

  /// Reads blocks of vertices ahead, except for vertices with lists and for a while after that has
  /// failed.
  bool read_blocks() {
    if (in_turn_ > 0) {
      --in_turn_;
      return false;
    }
    const PlyElement& vertices = header_.vertices();
    const auto parse = PointBlocks::of_lines([this](std::string_view line, Vec3& point) {
      if (is_blank_line(line)) return PointBlocks::Line::kNothing;
      return parse_vertex(line, point) ? PointBlocks::Line::kPoint : PointBlocks::Line::kOther;
    });
    if (blocks_.read(input_, parse, vertices.count - next_)) return true;
    in_turn_ = kBatchPoints;
    return false;
  }

  /// Parses a vertex without lists; returns false for any other line.
  bool parse_vertex(std::string_view line, Vec3& point) const {
    const std::vector<PlyProperty>& properties = header_.vertices().properties;
    const char* at = line.data();
    const char* const end = at + line.size();
    for (std::size_t i = 0; i < properties.size(); ++i) {
      at = skip_blanks(at, end);
      double value = 0;
      if (properties[i].list_count || !parse_number(at, end, value)) return false;
      if (at != end && !is_blank(*at)) return false;
      for (int axis = 0; axis < 3; ++axis) {
        if (header_.coordinates[axis] == i) point[axis] = value;
      }
    }
    return skip_blanks(at, end) == end;
  }

  void skip_element(const PlyElement& element) override {
    for (std::uint64_t row = 0; row < element.count; ++row) read_row(element, row, nullptr);
  }

  /// The next line that is not blank. Throws InputError where the file ends first.
  std::string_view next_row(const PlyElement& element, std::uint64_t row) {
    std::string_view line;
    do {
      if (!input_.next_line(line)) {
        refuse(input_.name(), "ends after line " + std::to_string(input_.line()) + " with " +
                                  std::to_string(row) + " of element " + excerpt(element.name) +
                                  "; expected " + std::to_string(element.count) + " of them");
      }
    } while (is_blank_line(line));
    return line;
  }

  static bool is_blank_line(std::string_view line) {
    const char* const end = line.data() + line.size();
    return skip_blanks(line.data(), end) == end;
  }

  /// Checks a last vertex whose line ends the file without a line break. It is accepted where the
  /// file should end there and all its values are present.
  void check_open_end(std::string_view line) {
    const std::string what = "the file ends without a line break";
    if (!vertices_end_file()) fail(what + " in the last vertex, so it is cut; expected more lines");
    if (line.ends_with('.')) fail(what + " within a number; expected all of it");
    note("no-line-break", what);
  }

  /// Throws InputError where the file has more lines than declared.
  void check_end() {
    std::string_view line;
    while (vertices_end_file() && input_.next_line(line)) {
      if (is_blank_line(line)) continue;
      fail(excerpt(line) + " is more than the header declares; expected the end behind " +
           std::to_string(header_.vertices().count) + " of element \"vertex\"");
    }
  }

  /// Reads one row of an element. point: receives the coordinates, or is null.
  void read_row(const PlyElement& element, std::uint64_t row, Vec3* point) {
    const std::string_view line = next_row(element, row);
    const char* const end = line.data() + line.size();
    const char* at = line.data();
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      const double value = next_number(at, end, property);
      if (property.list_count) {
        skip_items(at, end, property, value);
      } else if (point) {
        for (int axis = 0; axis < 3; ++axis) {
          if (header_.coordinates[axis] == i) (*point)[axis] = value;
        }
      }
    }
    if (skip_blanks(at, end) != end) {
      fail("more than the " + std::to_string(element.properties.size()) +
           " properties of element " + excerpt(element.name) + "; expected the end of the line");
    }
    if (point && !input_.line_terminated()) check_open_end(line);
  }

  double next_number(const char*& at, const char* end, const PlyProperty& property) const {
    at = skip_blanks(at, end);
    double value = 0;
    if (!parse_number(at, end, value) || (at != end && !is_blank(*at))) {
      fail("expected a number for property " + excerpt(property.name));
    }
    return value;
  }

  void skip_items(const char*& at, const char* end, const PlyProperty& property,
                  double count) const {
    if (!(count >= 0 && count <= 0xFFFFFFFFp0 && count == std::floor(count))) {
      fail("a list of " + shown(count) + " items; expected a whole number from 0");
    }
    for (double i = 0; i < count; ++i) next_number(at, end, property);
  }

  PointBlocks blocks_;
  std::size_t in_turn_ = 0;  ///< number of lines to read one by one before reading ahead
};

}  // namespace

std::unique_ptr<PointReader> read_ascii_ply(InputBuffer input, PlyHeader header) {
  return std::make_unique<AsciiPlyReader>(std::move(input), std::move(header));
}

}  // namespace clearway
