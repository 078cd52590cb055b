#include <algorithm>
#include <span>
#include <utility>

#include "io/formats/byte_load.hpp"
#include "io/formats/ply/ply_body_reader.hpp"
#include "io/formats/ply/ply_reader.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
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
                      "a list of " + shown(value) + " items; expected a count from 0");
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

}  // namespace clearway
