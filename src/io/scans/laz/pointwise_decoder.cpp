// Decoder for point formats 0 to 5. The items of a point follow each other in one stream, so all of
// them must be decoded.
#include <optional>

#include "io/files/bytes.hpp"
#include "io/scans/las/las_header.hpp"
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
  void begin() {
    if (first_) first_->begin();
    if (second_) second_->begin();
  }
  ArithmeticDecoder skip(ArithmeticDecoder decoder) {
    if (second_) return second_->skip(decoder);
    return first_ ? first_->skip(decoder) : decoder;
  }

 private:
  std::optional<Version1> first_;
  std::optional<Version2> second_;
};

/// The item GPSTIME11 in any version, or none.
class GpsTimeItem {
 public:
  explicit GpsTimeItem(unsigned version) {
    if (version == 1) first_.emplace();
    if (version == 2) second_.emplace();
  }
  /// bytes: those of the item in the first record.
  void begin(const std::byte* bytes) {
    if (first_) first_->begin(load<double>(bytes));
    if (second_) second_->begin(load<double>(bytes));
  }
  ArithmeticDecoder next(ArithmeticDecoder decoder) {
    if (second_) return second_->next(decoder);
    return first_ ? first_->next(decoder) : decoder;
  }
  double time() const { return second_ ? second_->time() : first_->time(); }

 private:
  std::optional<GpsTimeVersion1> first_;
  std::optional<GpsTimeVersion2> second_;
};

/// All items after POINT10.
class OtherItems {
 public:
  explicit OtherItems(const Scheme& scheme)
      : gps_time_(scheme.gps_time_version),
        rgb_(scheme.rgb_version),
        wave_packet_(scheme.wave_packet_version),
        bytes_(scheme.bytes_version, scheme.bytes) {}

  /// bytes: those of the items in the first record.
  void begin(const std::byte* bytes) {
    gps_time_.begin(bytes);
    rgb_.begin();
    wave_packet_.begin();
    bytes_.begin();
  }
  ArithmeticDecoder skip(ArithmeticDecoder decoder) {
    return bytes_.skip(wave_packet_.skip(rgb_.skip(gps_time_.next(decoder))));
  }
  double time() const { return gps_time_.time(); }  ///< GPS time of the last point
  static std::size_t most_bytes(const Scheme& scheme) {
    return kMostBytesGpsTime + kMostBytesRgb + kMostBytesWavePacket + kMostBytesByte * scheme.bytes;
  }

 private:
  GpsTimeItem gps_time_;
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
        most_bytes_(kMostBytesPoint10 + OtherItems::most_bytes(scheme) + kPointBytes),
        others_(scheme) {}

  void begin(const InputBuffer& input, const Chunk& chunk) override {
    const std::byte* cursor =
        window_.open(input, chunk.begin, chunk.end, static_cast<std::ptrdiff_t>(most_bytes_));
    const auto record = window_.take(cursor, record_bytes_);
    first_ = load<Quanta>(record.data());
    first_class_ = las_class_field(0).of(record.data());
    first_flags_ = las_flags_of(record.data(), 0);
    point_.begin(record.data());
    others_.begin(record.data() + kPointBytes);
    is_first_ = true;
    ends_there_ = chunk.ends_there;
    end_ = chunk.end;
    decoder_ = ArithmeticDecoder(window_.ahead(cursor));
  }

  void decode(PointRoom points) override {
    if (is_first_ && points.count > 0) {
      points.quanta[0] = first_;
      points.classes[0] = first_class_;
      if (points.flags) points.flags[0] = first_flags_;
      if (points.times) points.times[0] = others_.time();
      points = points.behind(1);
      is_first_ = false;
    }
    if (has_others_) {
      run<true>(points);
    } else {
      run<false>(points);
    }
    window_.ahead(decoder_.cursor());
    if (decoder_.damaged()) throw DamagedChunk{"holds bits that no encoder writes"};
  }

  std::uint64_t finish() override {
    const std::uint64_t end = window_.position(decoder_.cursor());
    if (end > end_) throw DamagedChunk{"its bytes end before its points"};
    if (ends_there_ && end != end_) throw unused_bytes(end_ - end);
    return end;
  }

 private:
  static constexpr std::size_t kPointBytes = 20;

  template <bool kHasOthers>
  void run(PointRoom points) {
    ArithmeticDecoder decoder = decoder_;
    for (std::size_t i = 0; i < points.count; ++i) {
      decoder.move_to(window_.ahead(decoder.cursor()));
      points.quanta[i] = point_.next(decoder);
      points.classes[i] = point_.point_class();
      if (points.flags) points.flags[i] = point_.flags();
      if constexpr (kHasOthers) {
        decoder = others_.skip(decoder);
        if (points.times) points.times[i] = others_.time();
      }
    }
    decoder_ = decoder;
  }

  std::size_t record_bytes_;
  bool has_others_;
  std::size_t most_bytes_;
  ByteWindow window_;
  ArithmeticDecoder decoder_;
  Point point_;
  OtherItems others_;
  Quanta first_{};
  std::uint8_t first_class_ = 0, first_flags_ = 0;
  bool is_first_ = false;
  bool ends_there_ = true;
  std::uint64_t end_ = 0;
};

}  // namespace

std::unique_ptr<ChunkDecoder> make_pointwise_decoder(const Scheme& scheme) {
  if (scheme.point_version == 1) return std::make_unique<PointwiseDecoder<Point10Version1>>(scheme);
  return std::make_unique<PointwiseDecoder<Point10Version2>>(scheme);
}

}  // namespace clearway::laz
