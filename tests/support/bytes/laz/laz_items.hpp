#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
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

/// A point with the fields of formats 0 to 3 and 6 to 8.
struct LazPoint {
  std::array<std::int32_t, 3> position{};
  unsigned returns = 1, number = 1;  ///< the pulse's number of returns, and which of them this is
  unsigned channel = 0;              ///< the scanner channel; formats 6 to 8
  std::uint16_t intensity = 0, source = 0;
  std::uint8_t classification = 0, user_data = 0;
  std::uint8_t flags = 0;  ///< four bits; formats 6 to 8
  std::int8_t angle = 0;
  std::uint64_t gps_time = 0;  ///< the bits of the double
  std::array<std::uint16_t, 4> colour{};
};

/// Encodes x, y and z in the way that all formats share. last: the last point of the same scanner
/// channel.
struct PositionCoder {
  IntegerCoder dx{32, 2}, dy{32, 22}, z{32, 20};
  std::array<MedianCoder, 16> medians_x, medians_y;
  std::array<std::int32_t, 8> heights{};

  void encode(ArithmeticEncoder& plane, ArithmeticEncoder& height, const LazPoint& last,
              const LazPoint& point, unsigned map, unsigned level) {
    const auto difference = [&](unsigned axis) {
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(point.position[axis]) -
                                       static_cast<std::uint32_t>(last.position[axis]));
    };
    const auto even = [](unsigned width, unsigned most) {
      return width < most ? width & ~1u : most;
    };
    const unsigned single = point.returns == 1 ? 1 : 0;
    dx.encode(plane, medians_x[map].median(), difference(0), single);
    medians_x[map].add(difference(0));
    dy.encode(plane, medians_y[map].median(), difference(1), single + even(dx.width, 20));
    medians_y[map].add(difference(1));
    z.encode(height, heights[level], point.position[2],
             single + even((dx.width + dy.width) / 2, 18));
    heights[level] = point.position[2];
  }
};

/// The coders of a value of so many symbols, one for each context, such as the value before.
struct CodersByValue {
  unsigned symbols = 256;
  std::map<unsigned, SymbolCoder> coders = {};

  void encode(ArithmeticEncoder& out, unsigned context, unsigned value) {
    out.symbol(coders.try_emplace(context, symbols).first->second, value);
  }
};

/// Encodes POINT10, version 2. Pulses have at most three returns, whose contexts are simple.
class Point10Coder {
 public:
  void encode(ArithmeticEncoder& out, const LazPoint& last, const LazPoint& point) {
    const unsigned map = map_of(point);
    const unsigned level = point.returns - point.number;
    const unsigned changed = (bits_of(point) != bits_of(last) ? 32 : 0) +
                             (point.intensity != intensities_[map] ? 16 : 0) +
                             (point.classification != last.classification ? 8 : 0) +
                             (point.angle != last.angle ? 4 : 0) +
                             (point.user_data != last.user_data ? 2 : 0) +
                             (point.source != last.source ? 1 : 0);
    out.symbol(changed_, changed);
    if (changed & 32) bits_.encode(out, bits_of(last), bits_of(point));
    if (changed & 16) {
      intensity_.encode(out, intensities_[map], point.intensity, std::min(map, 3u));
      intensities_[map] = point.intensity;
    }
    if (changed & 8) class_.encode(out, last.classification, point.classification);
    if (changed & 4) out.symbol(angle_, static_cast<std::uint8_t>(point.angle - last.angle));
    if (changed & 2) user_data_.encode(out, last.user_data, point.user_data);
    if (changed & 1) source_.encode(out, last.source, point.source, 0);
    position_.encode(out, out, last, point, map, level);
  }

 private:
  static unsigned bits_of(const LazPoint& point) { return point.number + 8 * point.returns; }
  static unsigned map_of(const LazPoint& point) {
    return point.returns * (point.returns - 1) / 2 + point.number - 1;
  }

  SymbolCoder changed_{64}, angle_{256};
  IntegerCoder intensity_{16, 4}, source_{16, 1};
  CodersByValue bits_, class_, user_data_;
  std::array<std::uint16_t, 16> intensities_{};
  PositionCoder position_;
};

/// Encodes the GPS times of GPSTIME11, version 2, or those of a layer, which has no symbols for a
/// time that stays.
class GpsTimeCoder {
 public:
  GpsTimeCoder(std::uint64_t first, bool only_changes)
      : missing_(only_changes ? 1 : 0), multiple_(516 - missing_), after_none_(6 - missing_) {
    sequences_[0].time = first;
  }

  void encode(ArithmeticEncoder& out, std::uint64_t time) {
    for (unsigned k = 0; k < 4; ++k) {
      if (!is_near(sequences_[(current_ + k) % 4].time, time)) continue;
      if (k > 0) put(out, 2 + k, 512 + k);
      current_ = (current_ + k) % 4;
      return encode_near(out, time);
    }
    put(out, 2, 512);
    difference_.encode(out, half(sequences_[current_].time >> 32), half(time >> 32), 8);
    out.bits(32, static_cast<std::uint32_t>(time));
    current_ = newest_ = (newest_ + 1) % 4;
    sequences_[current_] = {time};
  }

 private:
  struct Sequence {
    std::uint64_t time = 0;
    std::int32_t difference = 0;
    unsigned extremes = 0;
  };

  static std::int32_t half(std::uint64_t bits) { return static_cast<std::int32_t>(bits); }
  static bool is_near(std::uint64_t from, std::uint64_t to) {
    const auto step = static_cast<std::int64_t>(to - from);
    return step >= -0x80000000LL && step < 0x80000000LL;
  }
  /// Encodes a symbol, as it is called where the sequence has no difference, and else.
  void put(ArithmeticEncoder& out, unsigned none, unsigned otherwise) {
    if (sequences_[current_].difference == 0) return out.symbol(after_none_, none - missing_);
    out.symbol(multiple_, otherwise < 511 ? otherwise : otherwise - missing_);
  }

  void encode_near(ArithmeticEncoder& out, std::uint64_t time) {
    Sequence& sequence = sequences_[current_];
    const std::int32_t step = half(time - sequence.time);
    const std::int32_t usual = sequence.difference;
    sequence.time = time;
    if (step == 0 && missing_ == 0) return put(out, 0, 511);
    if (usual == 0) {
      put(out, 1, 0);
      sequence = {time, step, 0};
      return difference_.encode(out, 0, step, 0);
    }
    const auto factor =
        static_cast<int>(std::clamp<std::int64_t>(std::int64_t{step} / usual, -10, 500));
    put(out, 0, static_cast<unsigned>(factor < 0 ? 500 - factor : factor));
    const unsigned context = factor == -10  ? 6
                             : factor < 0   ? 5
                             : factor == 0  ? 7
                             : factor == 1  ? 1
                             : factor < 10  ? 2
                             : factor < 500 ? 3
                                            : 4;
    difference_.encode(out, half(static_cast<std::uint64_t>(std::int64_t{factor} * usual)), step,
                       context);
    if (factor == 1) sequence.extremes = 0;
    if ((context == 4 || context > 5) && ++sequence.extremes > 3) sequence = {time, step, 0};
  }

  unsigned missing_;
  SymbolCoder multiple_, after_none_;
  IntegerCoder difference_{32, 9};
  std::array<Sequence, 4> sequences_{};
  unsigned current_ = 0, newest_ = 0;
};

/// Encodes RGB12, version 2, without the values that follow from red, which the reader does not
/// need.
class ColourCoder {
 public:
  void encode(ArithmeticEncoder& out, const LazPoint& last, const LazPoint& point) {
    unsigned changed = 64;
    for (unsigned byte = 0; byte < 6; ++byte) {
      if (byte_of(point, byte) != byte_of(last, byte)) changed |= 1u << byte;
    }
    out.symbol(changed_, changed);
    for (const unsigned byte : {0, 1, 2, 4, 3, 5}) {
      if (changed >> byte & 1u) out.symbol(bytes_[byte], byte_of(point, byte));
    }
  }

 private:
  static unsigned byte_of(const LazPoint& point, unsigned byte) {
    return point.colour[byte / 2] >> (byte % 2 * 8) & 255u;
  }
  SymbolCoder changed_{128};
  std::vector<SymbolCoder> bytes_ = std::vector<SymbolCoder>(6, SymbolCoder(256));
};

/// Encodes the layers of POINT14 that hold coordinates, classes, flags and GPS times. Pulses have
/// at most two returns.
class Point14Coder {
 public:
  explicit Point14Coder(const LazPoint& first) : current_(first.channel) { start(current_, first); }

  void encode(const LazPoint& point) {
    Channel* channel = &channels_.at(current_);
    const LazPoint& before = channel->last;
    const unsigned context = (before.number == 1 ? 1 : 0) +
                             (before.number >= before.returns ? 2 : 0) +
                             (channel->time_changed ? 4 : 0);
    const bool other = point.channel != current_;
    const bool fresh = other && !channels_.contains(point.channel);
    const LazPoint last = other && !fresh ? channels_.at(point.channel).last : before;
    const bool time = point.gps_time != last.gps_time;
    const unsigned step = (point.number + 16 - last.number) % 16;
    const unsigned kind = step == 0 ? 0 : step == 1 ? 1 : step == 15 ? 2 : 3;
    plane.symbol(channel->changed[context], (other ? 64 : 0) + (time ? 16 : 0) +
                                                (point.returns != last.returns ? 4 : 0) + kind);
    if (other) {
      plane.symbol(channel->next_channel, (point.channel + 3 - current_) % 4);
      if (fresh) start(point.channel, before);
      current_ = point.channel;
      channel = &channels_.at(current_);
    }
    if (point.returns != last.returns) channel->returns.encode(plane, last.returns, point.returns);
    if (kind == 3 && time) channel->number.encode(plane, last.number, point.number);
    if (kind == 3 && !time) plane.symbol(channel->number_same_time, step - 2);
    const unsigned map = 2 * (point.returns * (point.returns - 1) / 2 + point.number - 1);
    channel->position.encode(plane, height, last, point, map + (time ? 1 : 0),
                             point.returns - point.number);
    const unsigned single = point.number == 1 && point.returns == 1 ? 1 : 0;
    channel->classes.encode(classes, (last.classification & 31u) * 2 + single,
                            point.classification);
    classes_change = classes_change || point.classification != last.classification;
    channel->flags.encode(flags, last.flags, point.flags);
    flags_change = flags_change || point.flags != last.flags;
    if (time) channel->gps_time.front().encode(times, point.gps_time);
    times_change = times_change || time;
    channel->last = point;
    channel->time_changed = time;
  }

  ArithmeticEncoder plane, height, classes, flags, times;
  bool classes_change = false;  ///< if no class differs from the last, their layer is left out
  bool flags_change = false, times_change = false;  ///< likewise

 private:
  struct Channel {
    LazPoint last;
    bool time_changed = false;
    std::vector<SymbolCoder> changed = std::vector<SymbolCoder>(8, SymbolCoder(128));
    SymbolCoder next_channel{3}, number_same_time{13};
    CodersByValue returns{16}, number{16}, classes, flags{64};
    PositionCoder position;
    std::vector<GpsTimeCoder> gps_time;  ///< one, since the channel began
  };

  void start(unsigned channel, const LazPoint& last) {
    Channel& started = channels_[channel];
    started.last = last;
    started.position.heights.fill(last.position[2]);
    started.gps_time.emplace_back(last.gps_time, true);
  }

  std::map<unsigned, Channel> channels_;
  unsigned current_;
};

}  // namespace clearway::test
