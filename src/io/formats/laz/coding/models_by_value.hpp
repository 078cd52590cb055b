#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "io/formats/laz/coding/arithmetic_decoder.hpp"

namespace clearway::laz {

/// A model of a byte for each value that the byte had in the point before. Models are created when
/// first needed.
class ModelsByValue {
 public:
  void renew() { used_.fill(false); }

  std::uint8_t decode(ArithmeticDecoder& decoder, std::uint8_t last) {
    if (!used_[last]) start(last);
    return static_cast<std::uint8_t>(decoder.symbol(*models_[last]));
  }

 private:
  void start(std::uint8_t last) {
    laz::renew(models_[last]);
    used_[last] = true;
  }

  std::array<std::unique_ptr<SymbolModel<256>>, 256> models_;
  std::array<bool, 256> used_{};
};

}  // namespace clearway::laz
