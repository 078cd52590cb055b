#include "io/scans/laz/items/gps_time11.hpp"

namespace clearway::laz {
namespace {

/// factor * difference modulo 2^32.
std::uint32_t product(std::uint32_t factor, std::int32_t difference) {
  return factor * static_cast<std::uint32_t>(difference);
}

/// Skips 64 bits, which have no model.
void skip_long(ArithmeticDecoder& decoder) {
  for (int i = 0; i < 4; ++i) decoder.bits(16);
}

}  // namespace

void GpsTimeVersion2::begin() { renew(models_); }

ArithmeticDecoder GpsTimeVersion2::skip(ArithmeticDecoder decoder) {
  // An encoder changes the sequence at most once.
  for (int changes = 0; changes < 4; ++changes) {
    const bool done = models_.sequences[models_.current].difference == 0
                          ? skip_after_none(decoder)
                          : skip_after_difference(decoder);
    if (done) return decoder;
  }
  decoder.note_damage();
  return decoder;
}

/// Skips a time in a sequence whose difference is 0; returns false where only the sequence changed.
bool GpsTimeVersion2::skip_after_none(ArithmeticDecoder& decoder) {
  const unsigned symbol = decoder.symbol(models_.after_none);
  Sequence& sequence = models_.sequences[models_.current];
  if (symbol == 1) {
    sequence.difference = static_cast<std::int32_t>(models_.difference.decode(decoder, 0, 0));
    sequence.extremes = 0;
  } else if (symbol == 2) {
    skip_jump(decoder);
  } else if (symbol > 2) {
    models_.current = (models_.current + symbol - 2) & 3u;
    return false;
  }
  return true;
}

bool GpsTimeVersion2::skip_after_difference(ArithmeticDecoder& decoder) {
  const unsigned symbol = decoder.symbol(models_.multiple);
  Sequence& sequence = models_.sequences[models_.current];
  if (symbol == 1) {
    models_.difference.decode(decoder, static_cast<std::uint32_t>(sequence.difference), 1);
    sequence.extremes = 0;
  } else if (symbol < kUnchanged) {
    skip_multiple(decoder, symbol);
  } else if (symbol == kJump) {
    skip_jump(decoder);
  } else if (symbol > kJump) {
    models_.current = (models_.current + symbol - kJump) & 3u;
    return false;
  }
  return true;
}

void GpsTimeVersion2::skip_multiple(ArithmeticDecoder& decoder, unsigned symbol) {
  Sequence& sequence = models_.sequences[models_.current];
  unsigned context = 7;
  std::uint32_t factor = 0;
  bool extreme = true;
  if (symbol > kGreatestMultiple) {
    context = symbol < kLeastMultiple ? 5 : 6;
    extreme = symbol == kLeastMultiple;
    factor = kGreatestMultiple - symbol;  // negative, modulo 2^32
  } else if (symbol > 0) {
    context = symbol < 10 ? 2 : symbol < kGreatestMultiple ? 3 : 4;
    extreme = symbol == kGreatestMultiple;
    factor = symbol;
  }
  const std::uint32_t difference =
      models_.difference.decode(decoder, product(factor, sequence.difference), context);
  if (extreme && ++sequence.extremes > 3) {
    sequence.difference = static_cast<std::int32_t>(difference);
    sequence.extremes = 0;
  }
}

/// Skips a time that is too far from the last one for 32 bits and begins a sequence.
void GpsTimeVersion2::skip_jump(ArithmeticDecoder& decoder) {
  models_.newest = (models_.newest + 1) & 3u;
  models_.difference.decode(decoder, 0, 8);
  decoder.bits(16);
  decoder.bits(16);
  models_.current = models_.newest;
  models_.sequences[models_.current] = {};
}

void GpsTimeVersion1::begin() { renew(models_); }

ArithmeticDecoder GpsTimeVersion1::skip(ArithmeticDecoder decoder) {
  if (models_.last == 0) {
    const unsigned symbol = decoder.symbol(models_.after_none);
    if (symbol == 1) {
      models_.last = static_cast<std::int32_t>(models_.difference.decode(decoder, 0, 0));
    } else if (symbol == 2) {
      skip_long(decoder);
    }
    return decoder;
  }
  const unsigned symbol = decoder.symbol(models_.multiple);
  if (symbol < kSymbols - 2) {
    skip_multiple(decoder, symbol);
  } else if (symbol == kSymbols - 2) {
    skip_long(decoder);
  }
  return decoder;
}

void GpsTimeVersion1::skip_multiple(ArithmeticDecoder& decoder, unsigned symbol) {
  if (symbol == 1) {
    models_.last = static_cast<std::int32_t>(
        models_.difference.decode(decoder, static_cast<std::uint32_t>(models_.last), 1));
    models_.extremes = 0;
    return;
  }
  std::uint32_t difference;
  if (symbol == 0) {
    difference =
        models_.difference.decode(decoder, static_cast<std::uint32_t>(models_.last / 4), 2);
  } else {
    const unsigned context = symbol < 10 ? 3 : symbol < 50 ? 4 : 5;
    difference = models_.difference.decode(decoder, product(symbol, models_.last), context);
  }
  const bool extreme = symbol == 0 || symbol == kSymbols - 3;
  if (extreme && ++models_.extremes > 3) {
    models_.last = static_cast<std::int32_t>(difference);
    models_.extremes = 0;
  }
}

}  // namespace clearway::laz
