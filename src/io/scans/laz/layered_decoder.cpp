// Decoder for point formats 6 to 10. The attributes of a chunk's points are in separate layers, so
// only those of the coordinates, of the class and, where wanted, of flags and GPS time are read.
#include <algorithm>
#include <array>
#include <numeric>

#include "io/files/bytes.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/laz/chunk_decoder.hpp"
#include "io/scans/laz/items/point14.hpp"

namespace clearway::laz {
namespace {

/// A layer, which is a stream of its own.
struct Layer {
  bool is_read = false;
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

/// The layers that are read: that of scanner channels, returns, x and y, and those of z, classes,
/// flags and GPS times.
enum : std::uint8_t { kPlane, kHeights, kClasses, kFlags, kTimes, kLayers };

class LayeredDecoder final : public ChunkDecoder {
 public:
  explicit LayeredDecoder(const Scheme& scheme) : scheme_(scheme) {}

  void begin(const InputBuffer& input, const Chunk& chunk) override {
    ByteWindow& head = layers_[kPlane].window;
    const std::byte* cursor =
        head.open(input, chunk.begin, chunk.end, scheme_.record_bytes + kReserve);
    const auto record = head.take(cursor, scheme_.record_bytes);
    take_first(record.data(), 6);
    // Copied, because the next take() moves the window's bytes.
    std::array<std::byte, kPointBytes> point;
    std::copy_n(record.begin(), kPointBytes, point.begin());
    const auto take_number = [&] { return load<std::uint32_t>(head.take(cursor, 4).data()); };
    const std::uint32_t points = take_number();
    if (points != chunk.points) {
      throw DamagedChunk{"holds " + std::to_string(points) + " points by its own count, but " +
                         std::to_string(chunk.points) + " by the header and the chunk table"};
    }
    std::array<std::uint64_t, kPointLayers> sizes{};
    std::uint64_t bytes = 0;
    for (std::uint32_t i = 0; i < scheme_.layers; ++i) {
      const std::uint32_t size = take_number();
      if (i < sizes.size()) sizes[i] = size;
      bytes += size;
    }
    const std::uint64_t start = head.position(cursor);
    end_ = start + bytes;
    if (end_ > chunk.end) {
      throw DamagedChunk{fmt::format("its layers have {} bytes more than it", end_ - chunk.end)};
    }
    if (chunk.ends_there && end_ != chunk.end) throw unused_bytes(chunk.end - end_);
    const bool wanted[] = {true, true, true, scheme_.with_flags, scheme_.with_times};
    constexpr std::size_t kPlaces[] = {0, 1, 2, 3, 8};  // of the layers among those of POINT14
    for (std::size_t i = 0; i < kLayers; ++i) {
      const std::uint64_t size = sizes[kPlaces[i]];
      Layer& layer = layers_[i];
      layer.is_read = chunk.points > 1 && wanted[i] && (i == kPlane || size > 0);
      if (!layer.is_read) continue;
      layer.open(input, std::accumulate(sizes.begin(), sizes.begin() + kPlaces[i], start), size);
    }
    if (chunk.points == 1) return;
    point_.begin(point.data(), layers_[kHeights].is_read);
    if (layers_[kTimes].is_read) point_.begin_times(time_);
  }

  std::uint64_t finish() override {
    for (const Layer& layer : layers_) {
      if (layer.is_read) layer.check();
    }
    return end_;
  }

 private:
  static constexpr std::size_t kPointBytes = 30;
  static constexpr std::ptrdiff_t kReserve = 16;
  static constexpr std::size_t kPointLayers = 9;  // layers of POINT14

  bool decode_others(PointRoom points) override {
    const bool has_classes = layers_[kClasses].is_read, has_flags = layers_[kFlags].is_read;
    const bool has_times = layers_[kTimes].is_read;
    if (has_times) {
      run<true, true>(points);
    } else if (has_classes || has_flags) {
      run<true, false>(points);
    } else {
      run<false, false>(points);
    }
    if (!has_classes) std::fill_n(points.classes, points.count, class_);
    if (!has_flags && points.flags) std::fill_n(points.flags, points.count, flags_);
    if (!has_times && points.times) std::fill_n(points.times, points.count, time_);
    return std::ranges::none_of(
        layers_, [](const Layer& layer) { return layer.is_read && layer.decoder.damaged(); });
  }

  /// kMayHaveClasses: whether there may be layers of classes or flags.
  template <bool kMayHaveClasses, bool kHasTimes>
  void run(PointRoom points) {
    auto& [plane_layer, height_layer, class_layer, flag_layer, time_layer] = layers_;
    const bool has_heights = height_layer.is_read, has_classes = class_layer.is_read;
    const bool has_flags = flag_layer.is_read;
    ArithmeticDecoder plane = plane_layer.decoder, heights = height_layer.decoder;
    ArithmeticDecoder classes = class_layer.decoder, flags = flag_layer.decoder;
    ArithmeticDecoder times = time_layer.decoder;
    for (std::size_t i = 0; i < points.count; ++i) {
      plane.move_to(plane_layer.window.ahead(plane.cursor()));
      if (has_heights) heights.move_to(height_layer.window.ahead(heights.cursor()));
      points.quanta[i] = point_.next(plane, heights);
      if (kMayHaveClasses && has_classes) {
        classes.move_to(class_layer.window.ahead(classes.cursor()));
        points.classes[i] = point_.next_class(classes);
      }
      if (kMayHaveClasses && has_flags) {
        flags.move_to(flag_layer.window.ahead(flags.cursor()));
        points.flags[i] = point_.next_flags(flags);
      }
      if constexpr (kHasTimes) {
        times.move_to(time_layer.window.ahead(times.cursor()));
        points.times[i] = point_.next_time(times);
      }
    }
    plane_layer.decoder = plane;
    height_layer.decoder = heights;
    class_layer.decoder = classes;
    flag_layer.decoder = flags;
    time_layer.decoder = times;
  }

  Scheme scheme_;
  std::array<Layer, kLayers> layers_;
  Point14 point_;
  std::uint64_t end_ = 0;
};

}  // namespace

std::unique_ptr<ChunkDecoder> make_layered_decoder(const Scheme& scheme) {
  return std::make_unique<LayeredDecoder>(scheme);
}

}  // namespace clearway::laz
