#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "io/files/bytes.hpp"
#include "io/scans/laz/coding/entropy_models.hpp"

namespace clearway::laz {

/// Most bytes that a GPS time takes, in any version.
constexpr std::size_t kMostBytesGpsTime = 64;

/// GPS times in four sequences, as the item GPSTIME11, version 2, has them, and the layer of times
/// of POINT14. The next time of a sequence is expected to differ by a multiple of the sequence's
/// difference. kOnlyChanges: whether only times that differ from the one before are in the stream,
/// as in a layer, so that two symbols are missing.
template <bool kOnlyChanges>
class GpsTimeSequences {
 public:
  /// Begins a chunk with the time of its first point.
  void begin(double time);
  /// Decodes the next time, which time() then returns.
  ArithmeticDecoder next(ArithmeticDecoder decoder);
  double time() const { return std::bit_cast<double>(models_.sequences[models_.current].time); }

 private:
  /// Symbols of `multiple` stand for 0 to 500 and then -1 to -10; after these come kUnchanged,
  /// which a layer lacks, and kJump, and further symbols choose another sequence.
  static constexpr std::uint32_t kGreatestMultiple = 500;
  static constexpr std::uint32_t kLeastMultiple = 510;  ///< the symbol of -10
  static constexpr std::uint32_t kUnchanged = 511;
  static constexpr std::uint32_t kJump = 512;
  static constexpr unsigned kMissing = kOnlyChanges ? 1 : 0;

  struct Sequence {
    std::uint64_t time = 0;  ///< the bits of the last time
    std::int32_t difference = 0;
    /// Number of differences that were no multiple since the last one that was.
    unsigned extremes = 0;
  };
  struct Models {
    SymbolModel<516 - kMissing> multiple;
    SymbolModel<6 - kMissing> after_none;
    IntegerModel<32, 9> difference;
    std::array<Sequence, 4> sequences{};
    unsigned current = 0, newest = 0;
  };

  bool next_after_none(ArithmeticDecoder& decoder);
  bool next_after_difference(ArithmeticDecoder& decoder);
  void next_multiple(ArithmeticDecoder& decoder, unsigned symbol);
  void next_jump(ArithmeticDecoder& decoder);
  /// Decodes a difference in a context and adds it to the time of the current sequence.
  std::int32_t add_difference(ArithmeticDecoder& decoder, std::uint32_t prediction,
                              unsigned context);

  Models models_ = fresh<Models>();
};

using GpsTimeVersion2 = GpsTimeSequences<false>;
using GpsTimeLayer = GpsTimeSequences<true>;

/// The item GPSTIME11, version 1, with one sequence.
class GpsTimeVersion1 {
 public:
  void begin(double time);
  ArithmeticDecoder next(ArithmeticDecoder decoder);
  double time() const { return std::bit_cast<double>(models_.time); }

 private:
  static constexpr unsigned kSymbols = 512;

  struct Models {
    SymbolModel<kSymbols> multiple;
    SymbolModel<3> after_none;
    IntegerModel<32, 6> difference;
    std::uint64_t time = 0;  ///< the bits of the last time
    std::int32_t last = 0;   ///< the last difference
    unsigned extremes = 0;
  };

  void next_multiple(ArithmeticDecoder& decoder, unsigned symbol);
  std::int32_t add_difference(ArithmeticDecoder& decoder, std::uint32_t prediction,
                              unsigned context);

  Models models_ = fresh<Models>();
};

}  // namespace clearway::laz
