#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// A number of bytes for messages, such as "1.5 GiB".
std::string format_size(std::uint64_t bytes);

/// A number for messages, such as "78,439".
std::string format_count(std::uint64_t count);

/// A number with its noun, such as "1 point" or "78,439 points". many: the plural, if it is not
/// `one` with an s.
std::string counted(std::uint64_t count, const std::string& one, const std::string& many = {});

/// A body of a vehicle in a sentence: "body left arm", and "the body" for one of that name.
std::string body_words(std::string_view name);

/// Texts as a list in a sentence, such as "times, names and stations".
std::string format_list(const std::vector<std::string>& texts);

/// Texts with commas between them, such as "near, few".
template <typename Texts>
std::string with_commas(const Texts& texts) {
  std::string out;
  for (const std::string_view text : texts) out.append(out.empty() ? "" : ", ").append(text);
  return out;
}

/// The shortest decimal that reads back as the same number; without an exponent from 1e-4 to 1e16.
std::string format_number(double value);

/// A number with so many digits, without zeros at its end, for messages; without an exponent from
/// 1e-9 to 1e16.
std::string format_digits(double value, int digits);

/// A number with four digits, for messages; 0 where it is no more than a rounding error.
std::string format_brief(double value);

/// The runs of ascending numbers as strings, such as "3" and "7-9".
template <typename Number>
std::vector<std::string> number_ranges(const std::vector<Number>& numbers) {
  std::vector<std::string> ranges;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    ranges.push_back(std::to_string(numbers[i]));
    if (last > i) ranges.back() += "-" + std::to_string(numbers[last]);
    i = last + 1;
  }
  return ranges;
}

/// Converts numbers from one unit to another. Each is rounded only once if one unit is a whole
/// multiple of the other: 9 millimetres are the double nearest to 0.009.
class UnitFactor {
 public:
  /// Lengths of both units in metres, above 0.
  explicit UnitFactor(double from, double to = 1)
      : factor_(from / to), parts_(std::round(to / from)), divides_(1 / parts_ == factor_) {}

  double operator()(double value) const { return divides_ ? value / parts_ : value * factor_; }
  double factor() const { return factor_; }

 private:
  double factor_, parts_;
  bool divides_;
};

}  // namespace clearway
