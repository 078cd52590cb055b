#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>

#include "io/scans/las/las_header.hpp"
#include "io/scans/laz/coding/entropy_models.hpp"
#include "io/scans/laz/items/coordinate_models.hpp"

namespace clearway::laz {

using Quanta = std::array<std::int32_t, 3>;

/// The fields of point formats 0 to 5 that later points depend on, because they choose models.
struct Point10Fields {
  Quanta position;
  std::uint8_t returns;  ///< byte 14 of the record: return number, number of returns, flags
  std::uint8_t classification;
  std::uint8_t user_data;

  explicit Point10Fields(const std::byte* record);
  Point10Fields() = default;
  unsigned return_number() const { return returns & 7u; }
  unsigned number_of_returns() const { return returns >> 3 & 7u; }
  unsigned scan_direction() const { return returns >> 6 & 1u; }
  std::uint8_t point_class() const { return classification & 0x1F; }
  std::uint8_t flags() const { return las_flags_of_class_byte(classification); }
};

/// The bits of `changed` in the item POINT10.
struct Point10Changes {
  static constexpr unsigned kReturns = 32, kIntensity = 16;        // in version 2
  static constexpr unsigned kOldIntensity = 32, kOldReturns = 16;  // in version 1
  static constexpr unsigned kClassification = 8, kScanAngle = 4, kUserData = 2, kSource = 1;
};

/// Most bytes that the item takes, in any version.
constexpr std::size_t kMostBytesPoint10 = 128;

/// The item POINT10, version 2, which LASzip has written since its release 2.0 (2011).
class Point10Version2 {
 public:
  void begin(const std::byte* record);
  /// Decodes the next point and returns its position.
  [[gnu::always_inline]] inline Quanta next(ArithmeticDecoder& decoder);
  /// Class of the last decoded point, and its flags as bits of PointFlags.
  std::uint8_t point_class() const { return last_.point_class(); }
  std::uint8_t flags() const { return last_.flags(); }

 private:
  struct Models {
    PlaneModels plane;
    HeightModel height;
    SymbolModel<64> changed;
    std::array<SymbolModel<256>, 2> scan_angle;
    IntegerModel<16, 4> intensity;
    IntegerModel<16, 1> source;
    std::array<MedianOfFive, 16> dx, dy;
    std::array<std::int32_t, 8> heights{};
  };

  /// Decodes the changed attributes except the byte of returns. Here and below a decoder is passed
  /// by value, because one whose address is known outside a loop is kept in memory.
  ArithmeticDecoder next_attributes(ArithmeticDecoder decoder, unsigned changed);

  Point10Fields last_;
  std::unique_ptr<Models> models_;  ///< null before the first chunk
  ModelsByValue returns_, classification_, user_data_;
};

/// The item POINT10, version 1.
class Point10Version1 {
 public:
  void begin(const std::byte* record);
  [[gnu::always_inline]] inline Quanta next(ArithmeticDecoder& decoder);
  std::uint8_t point_class() const { return last_.point_class(); }
  std::uint8_t flags() const { return last_.flags(); }

 private:
  struct Models {
    IntegerModel<32, 1> dx;
    IntegerModel<32, 20> dy, z;
    SymbolModel<64> changed;
    IntegerModel<16, 1> intensity, source;
    IntegerModel<8, 2> scan_angle;
    /// A ring buffer, whose oldest entry is replaced next.
    std::array<std::int32_t, 3> last_dx{}, last_dy{};
    unsigned oldest = 0;
  };

  ArithmeticDecoder next_attributes(ArithmeticDecoder decoder, unsigned changed, unsigned width);

  Point10Fields last_;
  std::unique_ptr<Models> models_;  ///< null before the first chunk
  ModelsByValue returns_, classification_, user_data_;
};

inline Quanta Point10Version2::next(ArithmeticDecoder& decoder) {
  Models& models = *models_;
  unsigned changed = decoder.symbol(models.changed);
  if ((changed & Point10Changes::kReturns) != 0) {
    last_.returns = returns_.decode(decoder, last_.returns);
    changed &= ~Point10Changes::kReturns;
  }
  if (changed != 0) decoder = next_attributes(decoder, changed);
  const unsigned returns = last_.number_of_returns(), number = last_.return_number();
  const unsigned map = kReturnMap10[returns][number];
  const bool single = returns == 1;
  auto& [x, y, z] = last_.position;

  const std::int32_t dx = models.plane.decode_dx(decoder, models.dx[map].median(), single);
  models.dx[map].add(dx);
  x = wrapping_sum(x, dx);
  const std::int32_t dy = models.plane.decode_dy(decoder, models.dy[map].median(), single);
  models.dy[map].add(dy);
  y = wrapping_sum(y, dy);
  std::int32_t& height = models.heights[return_level(returns, number)];
  z = models.height.decode(decoder, height, single, models.plane.mean_width());
  height = z;
  return last_.position;
}

inline std::int32_t median_of(const std::array<std::int32_t, 3>& v) {
  return std::max(std::min(v[0], v[1]), std::min(std::max(v[0], v[1]), v[2]));
}

inline Quanta Point10Version1::next(ArithmeticDecoder& decoder) {
  Models& models = *models_;
  auto& [x, y, z] = last_.position;
  std::int32_t& dx = models.last_dx[models.oldest];
  std::int32_t& dy = models.last_dy[models.oldest];
  models.oldest = (models.oldest + 1) % 3;

  dx = static_cast<std::int32_t>(
      models.dx.decode(decoder, static_cast<std::uint32_t>(median_of(models.last_dx)), 0));
  x = wrapping_sum(x, dx);
  unsigned width = models.dx.last_width();
  dy = static_cast<std::int32_t>(models.dy.decode(
      decoder, static_cast<std::uint32_t>(median_of(models.last_dy)), std::min(width, 19u)));
  y = wrapping_sum(y, dy);
  width = (width + models.dy.last_width()) / 2;
  z = static_cast<std::int32_t>(
      models.z.decode(decoder, static_cast<std::uint32_t>(z), std::min(width, 19u)));
  const unsigned changed = decoder.symbol(models.changed);
  if (changed != 0) decoder = next_attributes(decoder, changed, width);
  return last_.position;
}

}  // namespace clearway::laz
