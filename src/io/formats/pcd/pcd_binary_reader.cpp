#include <algorithm>
#include <utility>

#include "io/formats/pcd/pcd_body_reader.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

/// Reads binary data, in which the fields of a point are adjacent.
class BinaryPcdReader final : public PcdBodyReader {
 public:
  BinaryPcdReader(InputBuffer input, PcdHeader header)
      : PcdBodyReader(std::move(input), std::move(header)), stride_(header_.point_bytes(true)) {
    const std::uint64_t room = *input_.size() - input_.position();
    if (header_.points > room / stride_) {
      refuse(input_.name(), "ends at byte " + std::to_string(*input_.size()) + ", within point " +
                                std::to_string(room / stride_) + " of " +
                                std::to_string(header_.points) + "; expected " +
                                std::to_string(stride_) + " bytes for each");
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t field = header_.coordinates[axis];
      for (std::size_t i = 0; i < field; ++i) offsets_[axis] += header_.fields[i].bytes();
      loads_[axis] = load_of(header_.fields[field]);
    }
  }

 private:
  void read_points(std::span<Vec3> out) override {
    const std::size_t most = InputBuffer::kCapacity / stride_;
    while (!out.empty()) {
      const std::size_t count = std::min(most, out.size());
      const auto bytes = input_.take(count * stride_);
      if (bytes.empty()) refuse(input_.name(), "changed while it was read");
      for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        const std::byte* at = bytes.data() + offsets_[k];
        for (std::size_t i = 0; i < count; ++i, at += stride_) out[i][axis] = loads_[k](at);
      }
      out = out.subspan(count);
    }
  }

  void start_again() override {}
  void check_end() override { check_only_padding(); }

  std::size_t stride_;
  std::array<std::size_t, 3> offsets_{};
  std::array<PcdLoad, 3> loads_{};
};

}  // namespace

std::unique_ptr<PointReader> read_binary_pcd(InputBuffer input, PcdHeader header) {
  return std::make_unique<BinaryPcdReader>(std::move(input), std::move(header));
}

}  // namespace clearway
