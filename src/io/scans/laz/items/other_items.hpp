#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "io/scans/laz/coding/entropy_models.hpp"

/// Items of point formats 0 to 5 that do not affect coordinates. They are decoded as far as the
/// next symbols of the stream depend on them.
namespace clearway::laz {

constexpr std::size_t kMostBytesRgb = 64;
constexpr std::size_t kMostBytesWavePacket = 64;
constexpr std::size_t kMostBytesByte = 6;  ///< per byte

/// The item RGB12, version 2.
class RgbVersion2 {
 public:
  void begin() { renew(models_); }
  ArithmeticDecoder next(ArithmeticDecoder decoder);

 private:
  struct Models {
    SymbolModel<128> changed;
    std::array<SymbolModel<256>, 6> bytes;
  };
  Models models_ = fresh<Models>();
};

/// The item RGB12, version 1.
class RgbVersion1 {
 public:
  void begin() { renew(models_); }
  ArithmeticDecoder next(ArithmeticDecoder decoder);

 private:
  struct Models {
    SymbolModel<64> changed;
    IntegerModel<8, 6> bytes;
  };
  Models models_ = fresh<Models>();
};

/// The item WAVEPACKET13, which has only one version.
class WavePacket {
 public:
  void begin() { renew(models_); }
  ArithmeticDecoder next(ArithmeticDecoder decoder);

 private:
  struct Models {
    SymbolModel<256> descriptor;
    std::array<SymbolModel<4>, 4> offset_kind;
    IntegerModel<32, 1> offset, size, location;
    IntegerModel<32, 3> direction;
    unsigned last_kind = 0;
  };
  Models models_ = fresh<Models>();
};

/// The item BYTE, version 2: `count` extra bytes.
class BytesVersion2 {
 public:
  explicit BytesVersion2(std::size_t count) : models_(count, fresh<SymbolModel<256>>()) {}
  void begin();
  ArithmeticDecoder next(ArithmeticDecoder decoder);

 private:
  std::vector<SymbolModel<256>> models_;
};

/// The item BYTE, version 1: `count` extra bytes.
class BytesVersion1 {
 public:
  explicit BytesVersion1(std::size_t count)
      : widths_(count, fresh<SymbolModel<9>>()), corrector_(fresh<CorrectorModel<8>>()) {}
  void begin();
  ArithmeticDecoder next(ArithmeticDecoder decoder);

 private:
  std::vector<SymbolModel<9>> widths_;
  CorrectorModel<8> corrector_;
};

}  // namespace clearway::laz
