#pragma once

#include <concepts>
#include <cstdint>
#include <exception>
#include <optional>
#include <source_location>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"
#include "support/catch.hpp"

/// Checks that are compiled once: a call takes a tenth of the compile time of a CHECK. Each of them
/// counts as one assertion, goes on after a failure as CHECK does, and prints the line of the call,
/// the row of the table, and both values.
namespace clearway::test {

/// Where a check is called.
using Caller = std::source_location;

/// Names the row of a table in the message of every assertion that fails while it lives.
class RowName {
 public:
  explicit RowName(std::string_view name, const Caller& caller = Caller::current());

 private:
  Catch::ScopedMessage message_;
};

/// Fails the test with the line of the call and a text.
void fail_check(const std::string& text, const Caller& caller = Caller::current());

/// Checks that `text` holds the parts of `words` in their order. " ... " stands between parts, for
/// anything or nothing. Without words it checks that the text is empty.
void check_says(std::string_view text, std::string_view words,
                const Caller& caller = Caller::current());

/// Checks that `text` does not hold `part`.
void check_lacks(std::string_view text, std::string_view part,
                 const Caller& caller = Caller::current());

/// Checks that found and expected differ by at most `tolerance`; numbers that are not finite fail.
void check_near(double found, double expected, double tolerance,
                const Caller& caller = Caller::current());
void check_near(const Vec3& found, const Vec3& expected, double tolerance,
                const Caller& caller = Caller::current());
void check_near(std::span<const double> found, const std::vector<double>& expected,
                double tolerance, const Caller& caller = Caller::current());

void check_equal(double found, double expected, const Caller& caller = Caller::current());
void check_equal(std::string_view found, std::string_view expected,
                 const Caller& caller = Caller::current());
/// For strings, numbers, truth values and places.
template <typename Value>
void check_equal(const std::vector<Value>& found,
                 const std::type_identity_t<std::vector<Value>>& expected,
                 const Caller& caller = Caller::current());

/// A value that is missing fails.
void check_equal(const std::optional<double>& found, double expected,
                 const Caller& caller = Caller::current());
void check_equal(const std::optional<std::uint64_t>& found, std::uint64_t expected,
                 const Caller& caller = Caller::current());

/// Checks that two files have the same bytes, which are not printed.
void check_same(const std::string& found, const std::string& expected,
                const Caller& caller = Caller::current());

/// The codes of messages in their order, with "note " before those of notes: "note a, b, c".
std::string codes_of(const std::vector<Message>& messages);

/// A whole number of any type.
struct WholeNumber {
  std::uint64_t magnitude;
  bool is_negative;
};
void check_equal_whole(WholeNumber found, WholeNumber expected, const Caller& caller);

template <std::integral Number>
WholeNumber whole_number(Number number) {
  const bool is_negative = number < Number{0};
  const auto bits = static_cast<std::uint64_t>(number);
  return {is_negative ? std::uint64_t{0} - bits : bits, is_negative};
}

template <std::integral Found, std::integral Expected>
void check_equal(Found found, Expected expected, const Caller& caller = Caller::current()) {
  check_equal_whole(whole_number(found), whole_number(expected), caller);
}

/// Checks that `act` throws a `Kind` whose message holds the parts of `words` (see check_says()).
template <std::derived_from<std::exception> Kind = Error, typename Act>
void check_refused(const Act& act, std::string_view words,
                   const Caller& caller = Caller::current()) {
  try {
    act();
  } catch (const Kind& error) {
    check_says(error.what(), words, caller);
    return;
  }
  fail_check("nothing was refused", caller);
}

}  // namespace clearway::test
