#include "io/result/export/position_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>

#include "io/scans/requantize.hpp"

namespace clearway {
namespace {

/// The shortest decimal that gives a number back, without exponent.
std::string fixed(double value) {
  std::array<char, 400> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed).ptr;
  return {text.data(), end};
}

int digits_after_point(const std::string& decimal) {
  const std::size_t point = decimal.find('.');
  return point == std::string::npos ? 0 : static_cast<int>(decimal.size() - point - 1);
}

/// The decimal in units of 10^-digits; nullopt where its magnitude is not below `most`.
std::optional<std::int64_t> whole_of(std::string decimal, int digits, std::int64_t most) {
  const int missing = digits - digits_after_point(decimal);
  std::erase(decimal, '.');
  decimal.append(static_cast<std::size_t>(missing), '0');
  std::int64_t value = 0;
  const auto end = decimal.data() + decimal.size();
  const auto [stop, error] = std::from_chars(decimal.data(), end, value);
  if (error != std::errc() || stop != end || value > most || value < -most) return std::nullopt;
  return value;
}

}  // namespace

DecimalAxis::DecimalAxis(const Quantisation& quantisation, int axis)
    : quantisation_(quantisation), axis_(axis) {
  // So that 2^31 scales and the offset together are below 2^63.
  constexpr std::int64_t kMostScale = 1'000'000'000, kMostOffset = 4'000'000'000'000'000'000;
  constexpr int kMostDigits = 18;
  const std::string scale = fixed(quantisation.scale[axis]);
  const std::string offset = fixed(quantisation.offset[axis]);
  digits_ = std::max(digits_after_point(scale), digits_after_point(offset));
  if (digits_ > kMostDigits) return;
  const auto steps = whole_of(scale, digits_, kMostScale);
  const auto start = whole_of(offset, digits_, kMostOffset);
  if (steps && start) whole_ = {*steps, *start};
}

std::string_view DecimalAxis::text(double coordinate) {
  const auto quantum = whole_ ? quantum_at(quantisation_, axis_, coordinate) : std::nullopt;
  if (quantum) {
    const std::string_view digits = decimal(*quantum);
    double back = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), back);
    const double steps = (back - quantisation_.offset[axis_]) / quantisation_.scale[axis_];
    if (std::nearbyint(steps) == *quantum) return digits;
  }
  const auto end = std::to_chars(buffer_.data(), buffer_.data() + buffer_.size(), coordinate).ptr;
  return {buffer_.data(), end};
}

std::string_view DecimalAxis::decimal(std::int32_t quantum) {
  const std::int64_t value = std::int64_t{quantum} * (*whole_)[0] + (*whole_)[1];
  std::array<char, 32> digits{};
  const std::uint64_t size =
      value < 0 ? 0 - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), size).ptr;
  const auto count = static_cast<int>(end - digits.data());
  char* out = buffer_.data();
  if (value < 0) *out++ = '-';
  const int before = std::max(count - digits_, 0);
  if (before == 0) *out++ = '0';
  std::memcpy(out, digits.data(), static_cast<std::size_t>(before));
  out += before;
  char* const point = out;
  *out++ = '.';
  for (int i = count; i < digits_; ++i) *out++ = '0';
  std::memcpy(out, digits.data() + before, static_cast<std::size_t>(count - before));
  out += count - before;
  while (out != point && (out[-1] == '0' || out[-1] == '.')) {
    --out;
    if (*out == '.') break;
  }
  return {buffer_.data(), out};
}

}  // namespace clearway
