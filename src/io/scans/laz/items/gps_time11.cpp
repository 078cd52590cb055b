#include "io/scans/laz/items/gps_time11.hpp"

namespace clearway::laz {
namespace {

/// factor * difference modulo 2^32.
std::uint32_t product(std::uint32_t factor, std::int32_t difference) {
  return factor * static_cast<std::uint32_t>(difference);
}

/// Adds a difference to the bits of a time, modulo 2^64.
void move(std::uint64_t& time, std::int32_t difference) {
  time += static_cast<std::uint64_t>(std::int64_t{difference});
}

/// Decodes 32 bits, which have no model.
std::uint64_t half_of_long(ArithmeticDecoder& decoder) {
  const std::uint64_t low = decoder.bits(16);
  return std::uint64_t{decoder.bits(16)} << 16 | low;
}

}  // namespace

template <bool kOnlyChanges>
void GpsTimeSequences<kOnlyChanges>::begin(double time) {
  renew(models_);
  models_.sequences[0].time = std::bit_cast<std::uint64_t>(time);
}

template <bool kOnlyChanges>
ArithmeticDecoder GpsTimeSequences<kOnlyChanges>::next(ArithmeticDecoder decoder) {
  // An encoder changes the sequence at most once.
  for (int changes = 0; changes < 4; ++changes) {
    const bool done = models_.sequences[models_.current].difference == 0
                          ? next_after_none(decoder)
                          : next_after_difference(decoder);
    if (done) return decoder;
  }
  decoder.note_damage();
  return decoder;
}

template <bool kOnlyChanges>
std::int32_t GpsTimeSequences<kOnlyChanges>::add_difference(ArithmeticDecoder& decoder,
                                                            std::uint32_t prediction,
                                                            unsigned context) {
  const auto difference =
      static_cast<std::int32_t>(models_.difference.decode(decoder, prediction, context));
  move(models_.sequences[models_.current].time, difference);
  return difference;
}

/// Decodes a time in a sequence whose difference is 0; returns false where only the sequence
/// changed.
template <bool kOnlyChanges>
bool GpsTimeSequences<kOnlyChanges>::next_after_none(ArithmeticDecoder& decoder) {
  const unsigned symbol = decoder.symbol(models_.after_none) + kMissing;
  Sequence& sequence = models_.sequences[models_.current];
  if (symbol == 1) {
    sequence.difference = add_difference(decoder, 0, 0);
    sequence.extremes = 0;
  } else if (symbol == 2) {
    next_jump(decoder);
  } else if (symbol > 2) {
    models_.current = (models_.current + symbol - 2) & 3u;
    return false;
  }
  return true;
}

template <bool kOnlyChanges>
bool GpsTimeSequences<kOnlyChanges>::next_after_difference(ArithmeticDecoder& decoder) {
  unsigned symbol = decoder.symbol(models_.multiple);
  if (symbol >= kUnchanged) symbol += kMissing;
  Sequence& sequence = models_.sequences[models_.current];
  if (symbol == 1) {
    add_difference(decoder, static_cast<std::uint32_t>(sequence.difference), 1);
    sequence.extremes = 0;
  } else if (symbol < kUnchanged) {
    next_multiple(decoder, symbol);
  } else if (symbol == kJump) {
    next_jump(decoder);
  } else if (symbol > kJump) {
    models_.current = (models_.current + symbol - kJump) & 3u;
    return false;
  }
  return true;
}

template <bool kOnlyChanges>
void GpsTimeSequences<kOnlyChanges>::next_multiple(ArithmeticDecoder& decoder, unsigned symbol) {
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
  const std::int32_t difference =
      add_difference(decoder, product(factor, sequence.difference), context);
  if (extreme && ++sequence.extremes > 3) {
    sequence.difference = difference;
    sequence.extremes = 0;
  }
}

/// Decodes a time that is too far from the last one for 32 bits and begins a sequence.
template <bool kOnlyChanges>
void GpsTimeSequences<kOnlyChanges>::next_jump(ArithmeticDecoder& decoder) {
  const auto last = static_cast<std::uint32_t>(models_.sequences[models_.current].time >> 32);
  const std::uint64_t high = models_.difference.decode(decoder, last, 8);
  models_.current = models_.newest = (models_.newest + 1) & 3u;
  models_.sequences[models_.current] = {.time = high << 32 | half_of_long(decoder)};
}

template class GpsTimeSequences<false>;
template class GpsTimeSequences<true>;

void GpsTimeVersion1::begin(double time) {
  renew(models_);
  models_.time = std::bit_cast<std::uint64_t>(time);
}

std::int32_t GpsTimeVersion1::add_difference(ArithmeticDecoder& decoder, std::uint32_t prediction,
                                             unsigned context) {
  const auto difference =
      static_cast<std::int32_t>(models_.difference.decode(decoder, prediction, context));
  move(models_.time, difference);
  return difference;
}

ArithmeticDecoder GpsTimeVersion1::next(ArithmeticDecoder decoder) {
  const auto take_long = [&] {
    const std::uint64_t low = half_of_long(decoder);
    models_.time = half_of_long(decoder) << 32 | low;
  };
  if (models_.last == 0) {
    const unsigned symbol = decoder.symbol(models_.after_none);
    if (symbol == 1) {
      models_.last = add_difference(decoder, 0, 0);
    } else if (symbol == 2) {
      take_long();
    }
    return decoder;
  }
  const unsigned symbol = decoder.symbol(models_.multiple);
  if (symbol < kSymbols - 2) {
    next_multiple(decoder, symbol);
  } else if (symbol == kSymbols - 2) {
    take_long();
  }
  return decoder;
}

void GpsTimeVersion1::next_multiple(ArithmeticDecoder& decoder, unsigned symbol) {
  if (symbol == 1) {
    models_.last = add_difference(decoder, static_cast<std::uint32_t>(models_.last), 1);
    models_.extremes = 0;
    return;
  }
  std::int32_t difference = 0;
  if (symbol == 0) {
    difference = add_difference(decoder, static_cast<std::uint32_t>(models_.last / 4), 2);
  } else {
    const unsigned context = symbol < 10 ? 3 : symbol < 50 ? 4 : 5;
    difference = add_difference(decoder, product(symbol, models_.last), context);
  }
  const bool extreme = symbol == 0 || symbol == kSymbols - 3;
  if (extreme && ++models_.extremes > 3) {
    models_.last = difference;
    models_.extremes = 0;
  }
}

}  // namespace clearway::laz
