#include "io/formats/e57/e57_cursor.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "io/formats/byte_load.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

constexpr std::size_t kWordBytes = 8;

template <typename Float>
void decode_floats(const std::byte* at, std::span<double> out) {
  for (double& value : out) {
    value = static_cast<double>(load<Float>(at));
    at += sizeof(Float);
  }
}

/// Unpacks unsigned integers of `width` bits, least significant bit first. words_beyond: whether an
/// integer may reach into a ninth byte.
template <bool words_beyond, typename Use>
void unpack(const std::byte* bytes, std::uint64_t bit, unsigned width, std::span<double> out,
            Use use) {
  const std::uint64_t mask = ~std::uint64_t{0} >> (64 - width);
  for (double& value : out) {
    const std::byte* at = bytes + bit / 8;
    const unsigned shift = bit % 8;
    std::uint64_t word = load<std::uint64_t>(at) >> shift;
    if constexpr (words_beyond) {
      if (shift > 0) word |= std::uint64_t{load<std::uint8_t>(at + kWordBytes)} << (64 - shift);
    }
    value = use(word & mask);
    bit += width;
  }
}

}  // namespace

E57Cursor::E57Cursor(E57Packets& packets, const E57Field& field, std::size_t stream)
    : packets_(packets),
      field_(field),
      stream_(stream),
      next_packet_(packets.first()),
      buffer_(2 * kWordBytes) {}

std::uint64_t E57Cursor::available() const {
  return field_.bits == 0 ? std::numeric_limits<std::uint64_t>::max() : bits_left() / field_.bits;
}

bool E57Cursor::refill(const std::string& file) {
  if (!packets_.go_to(next_packet_)) return false;
  next_packet_ = packets_.next();
  if (packets_.restarts() && bits_left() > 0) {
    refuse_byte(file, packets_.physical_position(),
                "a data packet restarts its bytestreams within a record; expected whole records "
                "before it");
  }
  const std::size_t consumed = bit_ / 8;
  const std::size_t kept = bytes_ - consumed;  // less than a record, thus at most 8 bytes
  bit_ %= 8;
  const auto stream = packets_.stream(stream_);
  std::memmove(buffer_.data(), buffer_.data() + consumed, kept);
  bytes_ = kept + stream.size();
  buffer_.resize(std::max(buffer_.size(), bytes_ + 2 * kWordBytes));
  std::copy(stream.begin(), stream.end(), buffer_.begin() + static_cast<std::ptrdiff_t>(kept));
  std::fill_n(buffer_.begin() + static_cast<std::ptrdiff_t>(bytes_), 2 * kWordBytes, std::byte{0});
  return true;
}

void E57Cursor::decode(std::span<double> out) {
  const std::byte* at = buffer_.data() + bit_ / 8;
  switch (field_.kind) {
    case E57Field::Kind::kFloat32:
      decode_floats<float>(at, out);
      break;
    case E57Field::Kind::kFloat64:
      decode_floats<double>(at, out);
      break;
    case E57Field::Kind::kInteger:
    case E57Field::Kind::kText:  // fields of text never hold coordinates
      decode_integers(out);
      break;
  }
  bit_ += out.size() * field_.bits;
}

void E57Cursor::decode_integers(std::span<double> out) {
  // The sum wraps as the two's complement of the value does, for every width.
  const auto minimum = static_cast<std::uint64_t>(field_.minimum);
  const double scale = field_.scale, offset = field_.offset;
  const auto value_of = [=](std::uint64_t stored) {
    return static_cast<double>(static_cast<std::int64_t>(minimum + stored)) * scale + offset;
  };
  if (field_.bits == 0) {
    std::fill(out.begin(), out.end(), value_of(0));
  } else if (field_.bits <= 57) {
    unpack<false>(buffer_.data(), bit_, field_.bits, out, value_of);
  } else {
    unpack<true>(buffer_.data(), bit_, field_.bits, out, value_of);
  }
}

bool E57Cursor::holds_more() const {
  if (field_.bits == 0 || bits_left() < field_.bits) return false;
  for (std::uint64_t bit = bit_; bit < 8 * std::uint64_t{bytes_}; ++bit) {
    if (((load<std::uint8_t>(&buffer_[bit / 8]) >> (bit % 8)) & 1) != 0) return true;
  }
  return false;
}

}  // namespace clearway
