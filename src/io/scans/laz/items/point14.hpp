#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "io/scans/laz/coding/entropy_models.hpp"
#include "io/scans/laz/items/coordinate_models.hpp"
#include "io/scans/laz/items/gps_time11.hpp"

namespace clearway::laz {

/// Most bytes that a point takes in any layer.
constexpr std::size_t kMostBytesPoint14 = 64;

/// Decodes five layers of the item POINT14: one of scanner channels, returns, x and y, one of z,
/// one of classes, one of flags, and one of GPS times. Versions 2 to 4 do not differ in these.
class Point14 {
 public:
  using Quanta = std::array<std::int32_t, 3>;

  /// Begins a chunk with its first record. has_heights: whether the layer of z exists; otherwise z
  /// does not change.
  void begin(const std::byte* record, bool has_heights);
  /// Decodes the next point and returns its position. plane: the first layer; heights: the layer of
  /// z.
  [[gnu::always_inline]] inline Quanta next(ArithmeticDecoder& plane, ArithmeticDecoder& heights);
  /// Decodes the class of the point that next() decoded, from the layer of classes. Only where that
  /// layer exists; otherwise no class changes.
  [[gnu::always_inline]] inline std::uint8_t next_class(ArithmeticDecoder& classes);
  /// Decodes the flags of the point that next() decoded, bits of PointFlags, from the layer of
  /// flags. Only where that layer exists; otherwise no flag changes.
  [[gnu::always_inline]] inline std::uint8_t next_flags(ArithmeticDecoder& flags);
  /// Called after begin() where the layer of times exists and is read. time: that of the first
  /// record.
  void begin_times(double time);
  /// Decodes the time of the point that next() decoded, from the layer of times, which holds only
  /// those that changed. Called for each point, after begin_times().
  double next_time(ArithmeticDecoder& times);

 private:
  /// Bits of `changed`; the two lowest encode how the return number differs.
  static constexpr unsigned kChannelChanged = 64, kTimeChanged = 16, kReturnsChanged = 4;
  static constexpr unsigned kReturnChange = 3;

  struct Models {
    std::array<SymbolModel<128>, 8> changed;
    SymbolModel<3> channel;
    std::array<SymbolModel<16>, 16> number_of_returns, return_number;
    SymbolModel<13> return_number_same_time;
    PlaneModels plane;
    HeightModel height;
    std::array<MedianOfFive, 12> dx, dy;
  };
  struct Times {
    GpsTimeLayer sequences;
    bool used = false;
  };

  /// A scanner channel: its models and its last point.
  struct Channel {
    std::unique_ptr<Models> models;  ///< null before the channel is first used
    bool used = false;               ///< whether the channel was used in this chunk
    Quanta position{};
    std::array<std::int32_t, 8> heights{};
    unsigned number_of_returns = 0, return_number = 0;
    bool time_changed = false;
    std::uint8_t point_class = 0;
    /// The flags, above them the direction of the scan and the edge of the flight line
    std::uint8_t flags = 0;
  };

  void start(Channel& channel, const Channel& from);
  void start_times(unsigned channel, double time);
  ArithmeticDecoder next_channel(ArithmeticDecoder plane);
  ArithmeticDecoder next_returns(ArithmeticDecoder plane, unsigned changed);

  std::array<Channel, 4> channels_;
  std::array<ModelsByValue, 4> class_models_;       ///< models of the class for each channel
  std::array<ModelsByValueOf<64>, 4> flag_models_;  ///< models of the flags for each channel
  std::array<std::unique_ptr<Times>, 4> times_;     ///< GPS times of each channel; null before used
  unsigned last_timed_ = 0;  ///< channel of the point before, where times are read
  unsigned current_ = 0;
  bool has_heights_ = false;
};

inline Point14::Quanta Point14::next(ArithmeticDecoder& plane, ArithmeticDecoder& heights) {
  const Channel& last = channels_[current_];
  const unsigned context = (last.return_number == 1 ? 1 : 0) +
                           (last.return_number >= last.number_of_returns ? 2 : 0) +
                           (last.time_changed ? 4 : 0);
  const unsigned changed = plane.symbol(last.models->changed[context]);
  if ((changed & kChannelChanged) != 0) plane = next_channel(plane);
  if ((changed & (kReturnsChanged | kReturnChange)) != 0) plane = next_returns(plane, changed);

  Channel& channel = channels_[current_];
  Models& models = *channel.models;
  const unsigned time_changed = (changed & kTimeChanged) != 0 ? 1 : 0;
  channel.time_changed = time_changed != 0;
  const unsigned returns = channel.number_of_returns, number = channel.return_number;
  const unsigned map = 2u * kReturnMap14[returns][number] + time_changed;
  const bool single = returns == 1;
  auto& [x, y, z] = channel.position;

  const std::int32_t dx = models.plane.decode_dx(plane, models.dx[map].median(), single);
  models.dx[map].add(dx);
  x = wrapping_sum(x, dx);
  const std::int32_t dy = models.plane.decode_dy(plane, models.dy[map].median(), single);
  models.dy[map].add(dy);
  y = wrapping_sum(y, dy);
  if (has_heights_) {
    std::int32_t& height = channel.heights[return_level(returns, number)];
    z = models.height.decode(heights, height, single, models.plane.mean_width());
    height = z;
  }
  return channel.position;
}

inline std::uint8_t Point14::next_class(ArithmeticDecoder& classes) {
  Channel& channel = channels_[current_];
  const bool single = channel.return_number == 1 && channel.number_of_returns <= 1;
  const auto context =
      static_cast<std::uint8_t>((channel.point_class & 0x1Fu) << 1 | (single ? 1u : 0u));
  channel.point_class = class_models_[current_].decode(classes, context);
  return channel.point_class;
}

inline std::uint8_t Point14::next_flags(ArithmeticDecoder& flags) {
  Channel& channel = channels_[current_];
  channel.flags = flag_models_[current_].decode(flags, channel.flags);
  return channel.flags & 0x0F;
}

}  // namespace clearway::laz
