#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "io/formats/ply/ply_body_reader.hpp"
#include "io/formats/ply/ply_reader.hpp"
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
    for (; next_ < stop; ++next_) {
      Vec3 point{};
      read_row(vertices, next_, &point);
      batch.positions.push_back(point);
    }
    if (batch.positions.empty()) finish();
    return !batch.positions.empty();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    refuse_line(input_.name(), input_.line(), what);
  }

  void skip_element(const PlyElement& element) override {
    for (std::uint64_t row = 0; row < element.count; ++row) read_row(element, row, nullptr);
  }

  /// The next line that is not blank. A line without its line break counts as cut: the missing rest
  /// may be digits.
  std::string_view next_row(const PlyElement& element, std::uint64_t row) {
    std::string_view line;
    do {
      if (!input_.next_line(line)) {
        refuse(input_.name(), "ends after line " + std::to_string(input_.line()) + " with " +
                                  std::to_string(row) + " of element " + excerpt(element.name) +
                                  "; expected " + std::to_string(element.count) + " of them");
      }
      if (!input_.line_terminated()) {
        fail(
            "the file ends without a line break, so it may be cut; expected one behind the last "
            "line");
      }
    } while (skip_blanks(line.data(), line.data() + line.size()) == line.data() + line.size());
    return line;
  }

  /// point: receives the coordinates, or null.
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
};

}  // namespace

std::unique_ptr<PointReader> read_ascii_ply(InputBuffer input, PlyHeader header) {
  return std::make_unique<AsciiPlyReader>(std::move(input), std::move(header));
}

}  // namespace clearway
