// Point formats 6 to 10: the attributes of a chunk's points lie in layers of their own, so only
// those of the coordinates are read.
#include "io/formats/byte_load.hpp"
#include "io/formats/laz/chunk_decoder.hpp"
#include "io/formats/laz/items/point14.hpp"

namespace clearway::laz {
namespace {

/// A layer: a stream of its own.
struct Layer {
  std::uint64_t end = 0;
  ByteWindow window;
  ArithmeticDecoder decoder;

  void open(const InputBuffer& input, std::uint64_t begin, std::uint64_t size) {
    end = begin + size;
    decoder = ArithmeticDecoder(window.open(input, begin, end, kMostBytesPoint14));
  }
  void check() const {
    const std::uint64_t position = window.position(decoder.cursor());
    if (position > end) throw DamagedChunk{"its bytes end before its points"};
    if (position < end) throw unused_bytes(end - position);
  }
};

class LayeredDecoder final : public ChunkDecoder {
 public:
  explicit LayeredDecoder(const Scheme& scheme) : scheme_(scheme) {}

  void begin(const InputBuffer& input, const Chunk& chunk) override {
    const std::byte* cursor =
        plane_.window.open(input, chunk.begin, chunk.end, scheme_.record_bytes + kReserve);
    const auto record = plane_.window.take(cursor, scheme_.record_bytes);
    first_ = load<Quanta>(record.data());
    // The window's bytes move with the next take().
    std::array<std::byte, kPointBytes> point;
    std::copy_n(record.begin(), kPointBytes, point.begin());
    const auto points = take_number(cursor);
    if (points != chunk.points) {
      throw DamagedChunk{"holds " + std::to_string(points) + " points by its own count, but " +
                         std::to_string(chunk.points) + " by the header and the chunk table"};
    }
    const std::array<std::uint64_t, 2> sizes = take_sizes(cursor);
    const std::uint64_t layers = plane_.window.position(cursor);
    end_ = layers + layers_bytes_;
    if (end_ > chunk.end) {
      throw DamagedChunk{"its layers have " + std::to_string(end_ - chunk.end) +
                         " bytes more than it"};
    }
    if (chunk.ends_there && end_ != chunk.end) throw unused_bytes(chunk.end - end_);
    is_first_ = true;
    has_more_ = chunk.points > 1;
    if (!has_more_) return;
    point_.begin(point.data(), sizes[1] > 0);
    plane_.open(input, layers, sizes[0]);
    heights_.open(input, layers + sizes[0], sizes[1]);
    has_heights_ = sizes[1] > 0;
  }

  void decode(std::span<Quanta> points) override {
    if (is_first_ && !points.empty()) {
      points.front() = first_;
      points = points.subspan(1);
      is_first_ = false;
    }
    if (points.empty()) return;
    ArithmeticDecoder plane = plane_.decoder, heights = heights_.decoder;
    for (Quanta& point : points) {
      plane.move_to(plane_.window.ahead(plane.cursor()));
      if (has_heights_) heights.move_to(heights_.window.ahead(heights.cursor()));
      point = point_.next(plane, heights);
    }
    plane_.decoder = plane;
    heights_.decoder = heights;
    if (plane.damaged() || (has_heights_ && heights.damaged())) {
      throw DamagedChunk{"holds bits that no encoder writes"};
    }
  }

  std::uint64_t finish() override {
    if (has_more_) {
      plane_.check();
      if (has_heights_) heights_.check();
    }
    return end_;
  }

 private:
  static constexpr std::size_t kPointBytes = 30;
  static constexpr std::ptrdiff_t kReserve = 16;

  std::uint32_t take_number(const std::byte*& cursor) {
    return load<std::uint32_t>(plane_.window.take(cursor, 4).data());
  }

  /// The sizes of the first two layers. Leaves that of all in layers_bytes_.
  std::array<std::uint64_t, 2> take_sizes(const std::byte*& cursor) {
    std::array<std::uint64_t, 2> sizes{};
    layers_bytes_ = 0;
    for (std::uint32_t i = 0; i < scheme_.layers; ++i) {
      const std::uint32_t size = take_number(cursor);
      if (i < sizes.size()) sizes[i] = size;
      layers_bytes_ += size;
    }
    return sizes;
  }

  Scheme scheme_;
  Layer plane_, heights_;
  Point14 point_;
  Quanta first_{};
  std::uint64_t layers_bytes_ = 0;
  std::uint64_t end_ = 0;
  bool is_first_ = false, has_more_ = false, has_heights_ = false;
};

}  // namespace

std::unique_ptr<ChunkDecoder> make_layered_decoder(const Scheme& scheme) {
  return std::make_unique<LayeredDecoder>(scheme);
}

}  // namespace clearway::laz
