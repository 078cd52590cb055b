// Decoder for point formats 6 to 10. The attributes of a chunk's points are in separate layers, so
// only those of the coordinates, of the class and, where wanted, of flags and GPS time are read.
#include <array>
#include <numeric>

#include "io/files/bytes.hpp"
#include "io/scans/las/las_header.hpp"
#include "io/scans/laz/chunk_decoder.hpp"
#include "io/scans/laz/items/point14.hpp"

namespace clearway::laz {
namespace {

/// A layer, which is a stream of its own.
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
    // Copied, because the next take() moves the window's bytes.
    std::array<std::byte, kPointBytes> point;
    std::copy_n(record.begin(), kPointBytes, point.begin());
    class_ = las_class_field(6).of(point.data());
    flags_of_first_ = las_flags_of(point.data(), 6);
    time_ = load<double>(point.data() + *las_time_byte(6));
    const auto points = take_number(cursor);
    if (points != chunk.points) {
      throw DamagedChunk{"holds " + std::to_string(points) + " points by its own count, but " +
                         std::to_string(chunk.points) + " by the header and the chunk table"};
    }
    const std::array<std::uint64_t, kPointLayers> sizes = take_sizes(cursor);
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
    classes_.open(input, layers + sizes[0] + sizes[1], sizes[2]);
    has_heights_ = sizes[1] > 0;
    has_classes_ = sizes[2] > 0;
    has_flags_ = scheme_.with_flags && sizes[3] > 0;
    if (has_flags_) flags_.open(input, layers + sizes[0] + sizes[1] + sizes[2], sizes[3]);
    has_times_ = scheme_.with_times && sizes[kTimeLayer] > 0;
    if (!has_times_) return;
    point_.begin_times(time_);
    const std::uint64_t before = std::accumulate(sizes.begin(), sizes.begin() + kTimeLayer, layers);
    times_.open(input, before, sizes[kTimeLayer]);
  }

  void decode(PointRoom points) override {
    if (is_first_ && points.count > 0) {
      points.quanta[0] = first_;
      points.classes[0] = class_;
      if (points.flags) points.flags[0] = flags_of_first_;
      if (points.times) points.times[0] = time_;
      points = points.behind(1);
      is_first_ = false;
    }
    if (points.count == 0) return;
    if (has_times_) {
      run<true, true>(points);
    } else if (has_classes_ || has_flags_) {
      run<true, false>(points);
    } else {
      run<false, false>(points);
    }
    if (!has_classes_) std::fill_n(points.classes, points.count, class_);
    if (!has_flags_ && points.flags) std::fill_n(points.flags, points.count, flags_of_first_);
    if (!has_times_ && points.times) std::fill_n(points.times, points.count, time_);
    if (plane_.decoder.damaged() || (has_heights_ && heights_.decoder.damaged()) ||
        (has_classes_ && classes_.decoder.damaged()) || (has_flags_ && flags_.decoder.damaged()) ||
        (has_times_ && times_.decoder.damaged())) {
      throw DamagedChunk{"holds bits that no encoder writes"};
    }
  }

  std::uint64_t finish() override {
    if (has_more_) {
      plane_.check();
      if (has_heights_) heights_.check();
      if (has_classes_) classes_.check();
      if (has_flags_) flags_.check();
      if (has_times_) times_.check();
    }
    return end_;
  }

 private:
  static constexpr std::size_t kPointBytes = 30;
  static constexpr std::ptrdiff_t kReserve = 16;
  static constexpr std::size_t kPointLayers = 9;  // layers of POINT14
  static constexpr std::size_t kTimeLayer = 8;

  /// kMayHaveClasses: whether there may be layers of classes or flags.
  template <bool kMayHaveClasses, bool kHasTimes>
  void run(PointRoom points) {
    ArithmeticDecoder plane = plane_.decoder, heights = heights_.decoder;
    ArithmeticDecoder classes = classes_.decoder, flags = flags_.decoder;
    ArithmeticDecoder times = times_.decoder;
    for (std::size_t i = 0; i < points.count; ++i) {
      plane.move_to(plane_.window.ahead(plane.cursor()));
      if (has_heights_) heights.move_to(heights_.window.ahead(heights.cursor()));
      points.quanta[i] = point_.next(plane, heights);
      if (kMayHaveClasses && has_classes_) {
        classes.move_to(classes_.window.ahead(classes.cursor()));
        points.classes[i] = point_.next_class(classes);
      }
      if (kMayHaveClasses && has_flags_) {
        flags.move_to(flags_.window.ahead(flags.cursor()));
        points.flags[i] = point_.next_flags(flags);
      }
      if constexpr (kHasTimes) {
        times.move_to(times_.window.ahead(times.cursor()));
        points.times[i] = point_.next_time(times);
      }
    }
    plane_.decoder = plane;
    heights_.decoder = heights;
    classes_.decoder = classes;
    flags_.decoder = flags;
    times_.decoder = times;
  }

  std::uint32_t take_number(const std::byte*& cursor) {
    return load<std::uint32_t>(plane_.window.take(cursor, 4).data());
  }

  /// Takes the sizes of the layers of POINT14, and sets layers_bytes_ to the size of all layers.
  std::array<std::uint64_t, kPointLayers> take_sizes(const std::byte*& cursor) {
    std::array<std::uint64_t, kPointLayers> sizes{};
    layers_bytes_ = 0;
    for (std::uint32_t i = 0; i < scheme_.layers; ++i) {
      const std::uint32_t size = take_number(cursor);
      if (i < sizes.size()) sizes[i] = size;
      layers_bytes_ += size;
    }
    return sizes;
  }

  Scheme scheme_;
  Layer plane_, heights_, classes_, flags_, times_;
  Point14 point_;
  Quanta first_{};
  /// Class of the first point, and of all points where there is no layer of classes.
  std::uint8_t class_ = 0;
  /// Flags of the first point, and of all points where there is no layer of flags.
  std::uint8_t flags_of_first_ = 0;
  /// GPS time of the first point, and of all points where there is no layer of times.
  double time_ = 0;
  std::uint64_t layers_bytes_ = 0;
  std::uint64_t end_ = 0;
  bool is_first_ = false, has_more_ = false;
  bool has_heights_ = false, has_classes_ = false, has_flags_ = false, has_times_ = false;
};

}  // namespace

std::unique_ptr<ChunkDecoder> make_layered_decoder(const Scheme& scheme) {
  return std::make_unique<LayeredDecoder>(scheme);
}

}  // namespace clearway::laz
