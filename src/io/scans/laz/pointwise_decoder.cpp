// Decoder for point formats 0 to 5. The items of a point follow each other in one stream, so all of
// them must be decoded.
#include <optional>

#include "io/scans/laz/chunk_decoder.hpp"
#include "io/scans/laz/items/gps_time11.hpp"
#include "io/scans/laz/items/other_items.hpp"
#include "io/scans/laz/items/point10.hpp"

namespace clearway::laz {
namespace {

/// An item of version 1 or 2, or none.
template <typename Version1, typename Version2>
class Item {
 public:
  template <typename... Arguments>
  Item(unsigned version, Arguments... arguments) {
    if (version == 1) first_.emplace(arguments...);
    if (version == 2) second_.emplace(arguments...);
  }
  /// arguments: what the item needs of the first record.
  template <typename... Arguments>
  void begin(Arguments... arguments) {
    if (first_) first_->begin(arguments...);
    if (second_) second_->begin(arguments...);
  }
  ArithmeticDecoder next(ArithmeticDecoder decoder) {
    if (second_) return second_->next(decoder);
    return first_ ? first_->next(decoder) : decoder;
  }
  double time() const { return second_ ? second_->time() : first_->time(); }

 private:
  std::optional<Version1> first_;
  std::optional<Version2> second_;
};

/// All items after POINT10.
class OtherItems {
 public:
  explicit OtherItems(const Scheme& scheme)
      : gps_time_(scheme.versions[Scheme::kGpsTime]),
        rgb_(scheme.versions[Scheme::kRgb]),
        wave_packet_(scheme.versions[Scheme::kWavePacket]),
        bytes_(scheme.versions[Scheme::kBytes], scheme.bytes) {}

  void begin(double time) {
    gps_time_.begin(time);
    rgb_.begin();
    wave_packet_.begin();
    bytes_.begin();
  }
  ArithmeticDecoder next(ArithmeticDecoder decoder) {
    return bytes_.next(wave_packet_.next(rgb_.next(gps_time_.next(decoder))));
  }
  double time() const { return gps_time_.time(); }  ///< GPS time of the last point
  static std::size_t most_bytes(const Scheme& scheme) {
    return kMostBytesGpsTime + kMostBytesRgb + kMostBytesWavePacket + kMostBytesByte * scheme.bytes;
  }

 private:
  Item<GpsTimeVersion1, GpsTimeVersion2> gps_time_;
  Item<RgbVersion1, RgbVersion2> rgb_;
  Item<WavePacket, WavePacket> wave_packet_;
  Item<BytesVersion1, BytesVersion2> bytes_;
};

template <typename Point>
class PointwiseDecoder final : public ChunkDecoder {
 public:
  explicit PointwiseDecoder(const Scheme& scheme)
      : record_bytes_(scheme.record_bytes),
        has_others_(scheme.record_bytes > kPointBytes),
        has_times_(scheme.has_times()),
        most_bytes_(kMostBytesPoint10 + OtherItems::most_bytes(scheme) + kPointBytes),
        others_(scheme) {}

  void begin(const InputBuffer& input, const Chunk& chunk) override {
    const std::byte* cursor =
        window_.open(input, chunk.begin, chunk.end, static_cast<std::ptrdiff_t>(most_bytes_));
    const auto record = window_.take(cursor, record_bytes_);
    take_first(record.data(), has_times_ ? 1 : 0);
    point_.begin(record.data());
    others_.begin(time_);
    ends_there_ = chunk.ends_there;
    end_ = chunk.end;
    decoder_ = ArithmeticDecoder(window_.ahead(cursor));
  }

  std::uint64_t finish() override {
    const std::uint64_t end = window_.position(decoder_.cursor());
    if (end > end_) throw DamagedChunk{"its bytes end before its points"};
    if (ends_there_ && end != end_) throw unused_bytes(end_ - end);
    return end;
  }

 private:
  static constexpr std::size_t kPointBytes = 20;

  bool decode_others(PointRoom points) override {
    has_others_ ? run<true>(points) : run<false>(points);
    window_.ahead(decoder_.cursor());
    return !decoder_.damaged();
  }

  template <bool kHasOthers>
  void run(PointRoom points) {
    ArithmeticDecoder decoder = decoder_;
    for (std::size_t i = 0; i < points.count; ++i) {
      decoder.move_to(window_.ahead(decoder.cursor()));
      points.quanta[i] = point_.next(decoder);
      points.classes[i] = point_.point_class();
      if (points.flags) points.flags[i] = point_.flags();
      if constexpr (kHasOthers) {
        decoder = others_.next(decoder);
        if (points.times) points.times[i] = others_.time();
      }
    }
    decoder_ = decoder;
  }

  std::size_t record_bytes_;
  bool has_others_, has_times_;
  std::size_t most_bytes_;
  ByteWindow window_;
  ArithmeticDecoder decoder_;
  Point point_;
  OtherItems others_;
  bool ends_there_ = true;
  std::uint64_t end_ = 0;
};

}  // namespace

std::unique_ptr<ChunkDecoder> make_pointwise_decoder(const Scheme& scheme) {
  if (scheme.versions[Scheme::kPoint] == 1)
    return std::make_unique<PointwiseDecoder<Point10Version1>>(scheme);
  return std::make_unique<PointwiseDecoder<Point10Version2>>(scheme);
}

}  // namespace clearway::laz
