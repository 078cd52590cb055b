#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// The coder of LAZ, written as briefly as possible and without the reader's code.
namespace clearway::test {

struct SymbolCoder {
  std::vector<std::uint32_t> count, first;
  std::uint32_t total = 0, cycle, left;

  explicit SymbolCoder(unsigned symbols) : count(symbols, 1), first(symbols), cycle(symbols) {
    update();
    left = cycle = (symbols + 6) / 2;
  }
  void add(unsigned symbol) {
    ++count[symbol];
    if (--left == 0) update();
  }
  void update() {
    total += cycle;
    if (total > 1u << 15) {
      total = 0;
      for (auto& n : count) total += n = (n + 1) / 2;
    }
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < count.size(); ++i) {
      first[i] = (0x80000000u / total * sum) >> 16;
      sum += count[i];
    }
    left = cycle = std::min(cycle * 5 / 4, 8 * (static_cast<std::uint32_t>(count.size()) + 6));
  }
};

struct BitCoder {
  std::uint32_t zeros = 1, total = 2, share = 1u << 12, cycle = 4, left = 4;

  void add(unsigned bit) {
    zeros += 1 - bit;
    if (--left != 0) return;
    total += cycle;
    if (total > 1u << 13) {
      total = (total + 1) / 2;
      zeros = (zeros + 1) / 2;
      if (zeros == total) ++total;
    }
    share = (zeros * (0x80000000u / total)) >> 18;
    left = cycle = std::min(cycle * 5 / 4, 64u);
  }
};

class ArithmeticEncoder {
 public:
  void symbol(SymbolCoder& coder, unsigned symbol) {
    const bool last = symbol + 1 == coder.count.size();
    const std::uint32_t unit = length_ >> 15;
    const std::uint32_t low = coder.first[symbol] * unit;
    narrow(low, last ? length_ - low : coder.first[symbol + 1] * unit - low);
    coder.add(symbol);
  }
  void bit(BitCoder& coder, unsigned bit) {
    const std::uint32_t zeros = coder.share * (length_ >> 13);
    narrow(bit ? zeros : 0, bit ? length_ - zeros : zeros);
    coder.add(bit);
  }
  void bits(unsigned count, std::uint32_t value) {
    if (count > 19) {
      bits(16, value & 0xFFFFu);
      value >>= 16;
      count -= 16;
    }
    narrow(value * (length_ >> count), length_ >> count);
  }
  /// The encoded bytes, exactly as many as the decoder takes.
  std::string finish() {
    const bool one_more = length_ > 1u << 25;
    narrow(one_more ? 1u << 24 : 1u << 23, one_more ? 1u << 23 : 1u << 15);
    return bytes_ + std::string(one_more ? 3 : 2, '\0');
  }

 private:
  void narrow(std::uint32_t low, std::uint32_t length) {
    base_ += low;
    if (base_ < low) carry();
    for (length_ = length; length_ < 1u << 24; length_ <<= 8) {
      bytes_ += static_cast<char>(base_ >> 24);
      base_ <<= 8;
    }
  }
  void carry() {
    auto at = bytes_.rbegin();
    for (; *at == '\xFF'; ++at) *at = '\0';
    *at = static_cast<char>(*at + 1);
  }

  std::string bytes_;
  std::uint32_t base_ = 0, length_ = 0xFFFFFFFF;
};

/// Encodes integers of `bits` bits by their difference from a prediction.
struct IntegerCoder {
  unsigned bits, width = 0;
  std::vector<SymbolCoder> widths, places;
  BitCoder unit;

  IntegerCoder(unsigned bits_of_all, unsigned contexts)
      : bits(bits_of_all), widths(contexts, SymbolCoder(bits_of_all + 1)) {
    for (unsigned k = 1; k <= bits; ++k) places.emplace_back(1u << std::min(k, 8u));
  }

  void encode(ArithmeticEncoder& out, std::int64_t prediction, std::int64_t value,
              unsigned context) {
    const std::int64_t range = std::int64_t{1} << bits;
    std::int64_t c = value - prediction;
    if (c < -range / 2) c += range;
    if (c >= range / 2) c -= range;
    for (width = 0; c > std::int64_t{1} << width || c < 1 - (std::int64_t{1} << width);) ++width;
    out.symbol(widths[context], width);
    if (width == 0) return out.bit(unit, static_cast<unsigned>(c));
    if (width == 32) return;
    const auto place =
        static_cast<std::uint32_t>(c < 0 ? c + (std::int64_t{1} << width) - 1 : c - 1);
    if (width <= 8) return out.symbol(places[width - 1], place);
    out.symbol(places[width - 1], place >> (width - 8));
    out.bits(width - 8, place & ((1u << (width - 8)) - 1));
  }
};

/// The running median by which LAZ predicts differences: the middle of five values in order.
struct MedianCoder {
  std::vector<std::int32_t> values = std::vector<std::int32_t>(5, 0);
  bool high = true;

  std::int32_t median() const { return values[2]; }
  void add(std::int32_t value) {
    const std::int32_t before = median();
    values.erase(high ? values.end() - 1 : values.begin());
    high = high ? value < before : value <= before;
    auto at = values.begin();
    while (at != values.end() && *at < value) ++at;
    values.insert(at, value);
  }
};

}  // namespace clearway::test
