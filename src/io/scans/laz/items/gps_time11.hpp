#pragma once

#include <array>
#include <cstdint>

#include "io/scans/laz/coding/entropy_models.hpp"

namespace clearway::laz {

/// Most bytes that a GPS time takes, in any version.
constexpr std::size_t kMostBytesGpsTime = 64;

/// The item GPSTIME11, version 2: four sequences of times. The next time of a sequence is expected
/// to differ by a multiple of the sequence's difference. Only the state that later points depend on
/// is kept.
class GpsTimeVersion2 {
 public:
  void begin();
  ArithmeticDecoder skip(ArithmeticDecoder decoder);

 private:
  /// Symbols of `multiple` stand for 0 to 500 and then -1 to -10; after these come kUnchanged and
  /// kJump, and further symbols choose another sequence.
  static constexpr std::uint32_t kGreatestMultiple = 500;
  static constexpr std::uint32_t kLeastMultiple = 510;  ///< the symbol of -10
  static constexpr std::uint32_t kUnchanged = 511;
  static constexpr std::uint32_t kJump = 512;

  struct Sequence {
    std::int32_t difference = 0;
    /// Number of differences that were no multiple since the last one that was.
    unsigned extremes = 0;
  };
  struct Models {
    SymbolModel<516> multiple;
    SymbolModel<6> after_none;
    IntegerModel<32, 9> difference;
    std::array<Sequence, 4> sequences{};
    unsigned current = 0, newest = 0;
  };

  bool skip_after_none(ArithmeticDecoder& decoder);
  bool skip_after_difference(ArithmeticDecoder& decoder);
  void skip_multiple(ArithmeticDecoder& decoder, unsigned symbol);
  void skip_jump(ArithmeticDecoder& decoder);

  Models models_ = fresh<Models>();
};

/// The item GPSTIME11, version 1, with one sequence.
class GpsTimeVersion1 {
 public:
  void begin();
  ArithmeticDecoder skip(ArithmeticDecoder decoder);

 private:
  static constexpr unsigned kSymbols = 512;

  struct Models {
    SymbolModel<kSymbols> multiple;
    SymbolModel<3> after_none;
    IntegerModel<32, 6> difference;
    std::int32_t last = 0;
    unsigned extremes = 0;
  };

  void skip_multiple(ArithmeticDecoder& decoder, unsigned symbol);

  Models models_ = fresh<Models>();
};

}  // namespace clearway::laz
