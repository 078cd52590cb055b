#include "io/scans/ply/ply_reader.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include "core/util/format.hpp"
#include "io/files/bytes.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/text/point_blocks.hpp"
#include "io/scans/text_copy.hpp"

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
    const auto parse = PointLineBlocks::of_lines([this](std::string_view line, Vec3& point) {
      if (is_blank_line(line)) return PointLineBlocks::Line::kNothing;
      return parse_vertex(line, point) ? PointLineBlocks::Line::kPoint
                                       : PointLineBlocks::Line::kOther;
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
      fail("a list of " + format_number(count) + " items; expected a whole number from 0");
    }
    for (double i = 0; i < count; ++i) next_number(at, end, property);
  }

  PointLineBlocks blocks_;
  std::size_t in_turn_ = 0;  ///< number of lines to read one by one before reading ahead
};

}  // namespace

std::unique_ptr<PointReader> read_ascii_ply(InputBuffer input, PlyHeader header) {
  return std::make_unique<AsciiPlyReader>(std::move(input), std::move(header));
}

namespace {

/// Calls use(number) with a zero of the C++ type for `type`.
template <typename Use>
auto with_type(PlyType type, Use use) {
  switch (type) {
    case PlyType::kInt8:
      return use(std::int8_t{});
    case PlyType::kUint8:
      return use(std::uint8_t{});
    case PlyType::kInt16:
      return use(std::int16_t{});
    case PlyType::kUint16:
      return use(std::uint16_t{});
    case PlyType::kInt32:
      return use(std::int32_t{});
    case PlyType::kUint32:
      return use(std::uint32_t{});
    case PlyType::kFloat32:
      return use(float{});
    case PlyType::kFloat64:
      break;
  }
  return use(double{});
}

template <typename Number>
double load_double(const std::byte* bytes, bool swapped) {
  return static_cast<double>(swapped ? load_swapped<Number>(bytes) : load<Number>(bytes));
}

/// Decodes one coordinate of many elements that lie `stride` bytes apart.
void decode_axis(const std::byte* bytes, std::size_t stride, PlyType type, bool swapped, int axis,
                 std::span<Vec3> out) {
  with_type(type, [&]<typename Number>(Number) {
    const auto decode = [&](auto load_one) {
      const std::byte* at = bytes;
      for (Vec3& point : out) {
        point[axis] = static_cast<double>(load_one(at));
        at += stride;
      }
    };
    if (swapped) {
      decode([](const std::byte* at) { return load_swapped<Number>(at); });
    } else {
      decode([](const std::byte* at) { return load<Number>(at); });
    }
  });
}

class BinaryPlyReader final : public PlyBodyReader {
 public:
  BinaryPlyReader(InputBuffer input, PlyHeader header)
      : PlyBodyReader(std::move(input), std::move(header)),
        swapped_(header_.format == PlyFormat::kBigEndian) {
    check_size();
    refuse_if_copied_as_text(input_);
    refuse_seven_bits(input_);
    begin();
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < header_.coordinates[i]; ++k) {
        offsets_[i] += size_bytes(header_.vertices().properties[k].type);
      }
    }
  }

  bool read(PointBatch& batch) override {
    batch.quanta.clear();
    const std::uint64_t left = header_.vertices().count - next_;
    batch.positions.resize(std::min<std::uint64_t>(kBatchPoints, left));
    if (batch.positions.empty()) {
      check_end();
      return false;
    }
    if (const auto stride = header_.vertices().fixed_bytes()) {
      read_fixed(*stride, batch.positions);
    } else {
      for (Vec3& point : batch.positions) walk_row(header_.vertices(), next_++, &point);
    }
    return true;
  }

 private:
  /// Throws InputError where the file is smaller than the elements up to the vertices would be with
  /// empty lists.
  void check_size() const {
    std::uint64_t room = *input_.size() - input_.position();
    for (const PlyElement& element : std::span(header_.elements).first(header_.vertex + 1)) {
      const std::size_t bytes = element.least_bytes();
      if (bytes > 0 && element.count > room / bytes) {
        refuse(input_.name(), "ends at byte " + std::to_string(*input_.size()) + "; expected " +
                                  std::to_string(element.count) + " of element " +
                                  excerpt(element.name) + " with " + std::to_string(bytes) +
                                  " bytes or more each");
      }
      room -= element.count * bytes;
    }
  }

  /// Throws InputError where data follows the last vertex and should not. A line break there is
  /// accepted.
  void check_end() {
    if (!vertices_end_file()) return;
    const std::uint64_t end = input_.position();
    const std::uint64_t more = *input_.size() - end;
    if (more == 0) return;
    const auto bytes = more <= 2 ? input_.take(more) : std::span<const std::byte>();
    const auto is_break = [](std::byte b) { return b == std::byte{'\n'} || b == std::byte{'\r'}; };
    if (!bytes.empty() && std::all_of(bytes.begin(), bytes.end(), is_break)) return;
    refuse_byte(input_.name(), end,
                std::to_string(more) + " bytes more than the header declares; expected the end " +
                    "behind " + std::to_string(header_.vertices().count) +
                    " of element \"vertex\"");
  }

  [[noreturn]] void refuse_cut(const PlyElement& element, std::uint64_t row) const {
    refuse(input_.name(), "ends at byte " + std::to_string(input_.end_position()) + ", within " +
                              std::to_string(row) + " of element " + excerpt(element.name) +
                              "; expected " + std::to_string(element.count) + " of them");
  }

  void skip_element(const PlyElement& element) override {
    if (const auto bytes = element.fixed_bytes()) {
      if (!input_.skip(*bytes * element.count)) refuse_cut(element, element.count);
      return;
    }
    for (std::uint64_t row = 0; row < element.count; ++row) walk_row(element, row, nullptr);
  }

  void read_fixed(std::size_t stride, std::span<Vec3> out) {
    const PlyElement& vertices = header_.vertices();
    const std::size_t most = InputBuffer::kCapacity / stride;
    while (!out.empty()) {
      const std::size_t count = std::min(most, out.size());
      const auto bytes = input_.take(count * stride);
      if (bytes.empty()) refuse_cut(vertices, next_);
      for (int axis = 0; axis < 3; ++axis) {
        const PlyType type = vertices.properties[header_.coordinates[axis]].type;
        decode_axis(bytes.data() + offsets_[axis], stride, type, swapped_, axis, out.first(count));
      }
      out = out.subspan(count);
      next_ += count;
    }
  }

  /// Consumes one element that may hold lists. point: receives its coordinates, or is null.
  void walk_row(const PlyElement& element, std::uint64_t row, Vec3* point) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      const std::uint64_t start = input_.position();
      const double value = take_number(element, row, property.list_count.value_or(property.type));
      if (property.list_count) {
        if (value < 0) {
          refuse_byte(input_.name(), start,
                      "a list of " + format_number(value) + " items; expected a count from 0");
        }
        const auto items = static_cast<std::uint64_t>(value);
        if (!input_.skip(items * size_bytes(property.type))) refuse_cut(element, row);
      } else if (point) {
        for (int axis = 0; axis < 3; ++axis) {
          if (header_.coordinates[axis] == i) (*point)[axis] = value;
        }
      }
    }
  }

  double take_number(const PlyElement& element, std::uint64_t row, PlyType type) {
    const auto bytes = input_.take(size_bytes(type));
    if (bytes.empty()) refuse_cut(element, row);
    return with_type(
        type, [&]<typename Number>(Number) { return load_double<Number>(bytes.data(), swapped_); });
  }

  bool swapped_;
  std::size_t offsets_[3] = {0, 0, 0};  ///< byte offsets of x, y, z in a vertex without lists
};

}  // namespace

std::unique_ptr<PointReader> read_binary_ply(InputBuffer input, PlyHeader header) {
  return std::make_unique<BinaryPlyReader>(std::move(input), std::move(header));
}

std::unique_ptr<PointReader> read_ply(InputBuffer input) {
  PlyHeader header = read_ply_header(input);
  return header.format == PlyFormat::kAscii ? read_ascii_ply(std::move(input), std::move(header))
                                            : read_binary_ply(std::move(input), std::move(header));
}

}  // namespace clearway
