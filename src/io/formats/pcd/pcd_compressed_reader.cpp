#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "io/formats/byte_load.hpp"
#include "io/formats/pcd/lzf_stream.hpp"
#include "io/formats/pcd/pcd_body_reader.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

// Bytes of a column that are decoded at a time.
constexpr std::size_t kColumnBytes = std::size_t{1} << 16;

/// Reads compressed data, in which each field is stored for all points before the next field. Three
/// decoders stand in the columns of x, y and z at the same time, so that memory is constant.
class CompressedPcdReader final : public PcdBodyReader {
 public:
  CompressedPcdReader(InputBuffer input, PcdHeader header)
      : PcdBodyReader(std::move(input), std::move(header)) {
    const auto sizes = input_.take(2 * sizeof(std::uint32_t));
    if (sizes.empty()) {
      refuse(input_.name(), "ends at byte " + std::to_string(input_.end_position()) +
                                "; expected the sizes of the compressed data, 8 bytes");
    }
    const auto compressed = load<std::uint32_t>(sizes.data());
    decoded_bytes_ = load<std::uint32_t>(sizes.data() + sizeof(std::uint32_t));
    begin_ = input_.position();
    end_ = begin_ + compressed;
    if (end_ > *input_.size()) {
      refuse(input_.name(), "ends at byte " + std::to_string(*input_.size()) +
                                "; expected compressed data up to byte " + std::to_string(end_));
    }
    const std::uint64_t bytes = header_.point_bytes(false);
    if (decoded_bytes_ % bytes != 0 || decoded_bytes_ / bytes != header_.points) {
      refuse(input_.name(), "compressed data of " + std::to_string(decoded_bytes_) + " bytes for " +
                                std::to_string(header_.points) + " points; expected " +
                                std::to_string(bytes) + " bytes for each");
    }
    first_point_ = input_.mark();
  }

 private:
  void read_points(std::span<Vec3> out) override {
    if (!starts_[0]) find_columns();
    if (next_ == 0) columns_ = starts_;
    for (std::size_t axis = 0; axis < 3; ++axis) read_column(axis, out);
  }

  void start_again() override {}

  void check_end() override {
    if (!starts_[0]) find_columns();
    input_.skip(end_ - begin_);
    check_only_padding();
  }

  /// Decodes everything once, to find where x, y and z start and to check that the data is sound.
  void find_columns() {
    std::array<std::uint64_t, 3> begins{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t i = 0; i < header_.coordinates[axis]; ++i) {
        const PcdField& field = header_.fields[i];
        if (!field.padding()) begins[axis] += field.bytes() * header_.points;
      }
    }
    std::array<std::size_t, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return begins[a] < begins[b]; });
    LzfStream stream(input_.file(), begin_, end_, decoded_bytes_);
    for (const std::size_t axis : order) {
      stream.skip(begins[axis] - stream.position());
      starts_[axis] = stream;
    }
    stream.skip(decoded_bytes_ - stream.position());
    stream.check_end();
  }

  void read_column(std::size_t axis, std::span<Vec3> out) {
    const PcdField& field = header_.fields[header_.coordinates[axis]];
    const PcdLoad load = load_of(field);
    const std::size_t most = kColumnBytes / field.bytes();
    while (!out.empty()) {
      const std::size_t count = std::min(most, out.size());
      bytes_.resize(count * field.bytes());
      columns_[axis]->read(bytes_);
      for (std::size_t i = 0; i < count; ++i) {
        out[i][static_cast<int>(axis)] = load(bytes_.data() + i * field.bytes());
      }
      out = out.subspan(count);
    }
  }

  std::uint64_t begin_ = 0;  // position of the compressed bytes in the file
  std::uint64_t end_ = 0;
  std::uint64_t decoded_bytes_ = 0;
  std::array<std::optional<LzfStream>, 3> starts_;   // decoders at the first point
  std::array<std::optional<LzfStream>, 3> columns_;  // decoders at the next point
  std::vector<std::byte> bytes_;
};

}  // namespace

std::unique_ptr<PointReader> read_compressed_pcd(InputBuffer input, PcdHeader header) {
  return std::make_unique<CompressedPcdReader>(std::move(input), std::move(header));
}

}  // namespace clearway
