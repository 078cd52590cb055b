#include "support/compare.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace clearway::test {

namespace {

constexpr std::string_view kGap = " ... ";

/// What SUCCEED() and FAIL_CHECK() do, with the line of the caller.
void report(bool holds, const std::string& text, const Caller& caller) {
  const Catch::SourceLineInfo line(caller.file_name(), caller.line());
  Catch::AssertionHandler handler("check", line, "", Catch::ResultDisposition::ContinueOnFailure);
  handler.handleMessage(holds ? Catch::ResultWas::Ok : Catch::ResultWas::ExplicitFailure,
                        std::string(text));
  handler.complete();
}

/// Digits from which the number can be read again.
std::string shown(double number) {
  std::ostringstream out;
  out.precision(17);
  out << number;
  return out.str();
}
std::string shown(const Vec3& place) {
  return "(" + shown(place.x) + ", " + shown(place.y) + ", " + shown(place.z) + ")";
}
std::string shown(std::string_view text) { return "\"" + std::string(text) + "\""; }
std::string shown(const std::string& text) { return shown(std::string_view(text)); }
std::string shown(bool value) { return value ? "true" : "false"; }
template <std::unsigned_integral Number>
std::string shown(Number number) {
  return std::to_string(number);
}
std::string shown(WholeNumber number) {
  return (number.is_negative ? "-" : "") + std::to_string(number.magnitude);
}
/// All elements of a list, or its first 100.
template <typename List>
std::string shown_list(const List& list) {
  constexpr std::size_t kMost = 100;
  std::string text = std::to_string(list.size()) + " elements {";
  for (std::size_t i = 0; i < list.size() && i < kMost; ++i) {
    text += (i == 0 ? "" : ", ") + shown(list[i]);
  }
  return text + (list.size() > kMost ? ", ...}" : "}");
}

/// What was found and what was expected, as texts.
struct Difference {
  std::string found, expected;
};

/// `difference` makes the texts, where they are needed.
template <typename MakeDifference>
void check(bool holds, const Caller& caller, const MakeDifference& difference) {
  if (holds) {
    report(true, {}, caller);
    return;
  }
  const Difference texts = difference();
  fail_check("found:    " + texts.found + "\nexpected: " + texts.expected, caller);
}

}  // namespace

RowName::RowName(std::string_view name, const Caller& caller)
    : message_(Catch::MessageBuilder("row",
                                     Catch::SourceLineInfo(caller.file_name(), caller.line()),
                                     Catch::ResultWas::Info)
               << "row " << shown(name)) {}

void fail_check(const std::string& text, const Caller& caller) { report(false, text, caller); }

void check_says(std::string_view text, std::string_view words, const Caller& caller) {
  if (words.empty()) {
    check(text.empty(), caller, [&] { return Difference{shown(text), "an empty text"}; });
    return;
  }
  std::size_t from = 0;
  for (std::string_view rest = words; !rest.empty();) {
    const std::string_view part = rest.substr(0, rest.find(kGap));
    const std::size_t at = text.find(part, from);
    if (at == text.npos) {
      fail_check(
          "found:    " + shown(text) + "\nexpected: " + shown(words) + "\nmissing:  " + shown(part),
          caller);
      return;
    }
    from = at + part.size();
    rest.remove_prefix(std::min(rest.size(), part.size() + kGap.size()));
  }
  report(true, {}, caller);
}

void check_same(const std::string& found, const std::string& expected, const Caller& caller) {
  if (found == expected) {
    SUCCEED();
    return;
  }
  const auto differs = std::ranges::mismatch(found, expected).in1 - found.begin();
  fail_check("of " + std::to_string(found.size()) + " and " + std::to_string(expected.size()) +
                 " bytes the first " + std::to_string(differs) + " are the same",
             caller);
}

std::string codes_of(const std::vector<Message>& messages) {
  std::string codes;
  for (const Message& message : messages) {
    const bool warns = message.severity == Message::Severity::kWarning;
    codes += (codes.empty() ? "" : ", ") + std::string(warns ? "" : "note ") + message.code;
  }
  return codes;
}

void check_lacks(std::string_view text, std::string_view part, const Caller& caller) {
  check(text.find(part) == text.npos, caller, [&] {
    return Difference{shown(text), "a text without " + shown(part)};
  });
}

void check_near(double found, double expected, double tolerance, const Caller& caller) {
  check(std::abs(found - expected) <= tolerance, caller, [&] {
    return Difference{shown(found), shown(expected) + " within " + shown(tolerance)};
  });
}

void check_near(const Vec3& found, const Vec3& expected, double tolerance, const Caller& caller) {
  check(std::abs(found.x - expected.x) <= tolerance &&
            std::abs(found.y - expected.y) <= tolerance &&
            std::abs(found.z - expected.z) <= tolerance,
        caller, [&] {
          return Difference{shown(found), shown(expected) + " within " + shown(tolerance)};
        });
}

void check_near(std::span<const double> found, const std::vector<double>& expected,
                double tolerance, const Caller& caller) {
  bool holds = found.size() == expected.size();
  for (std::size_t i = 0; holds && i < found.size(); ++i) {
    holds = std::abs(found[i] - expected[i]) <= tolerance;
  }
  check(holds, caller, [&] {
    return Difference{shown_list(found), shown_list(expected) + " within " + shown(tolerance)};
  });
}

void check_equal(double found, double expected, const Caller& caller) {
  check(found == expected, caller, [&] { return Difference{shown(found), shown(expected)}; });
}
void check_equal(std::string_view found, std::string_view expected, const Caller& caller) {
  check(found == expected, caller, [&] { return Difference{shown(found), shown(expected)}; });
}
void check_equal_whole(WholeNumber found, WholeNumber expected, const Caller& caller) {
  check(found.magnitude == expected.magnitude && found.is_negative == expected.is_negative, caller,
        [&] {
          return Difference{shown(found), shown(expected)};
        });
}

template <typename Value>
void check_equal(const std::vector<Value>& found,
                 const std::type_identity_t<std::vector<Value>>& expected, const Caller& caller) {
  const std::size_t common = std::min(found.size(), expected.size());
  std::size_t differs = 0;
  while (differs < common && found[differs] == expected[differs]) ++differs;
  if (differs == found.size() && differs == expected.size()) {
    report(true, {}, caller);
    return;
  }
  fail_check("element " + std::to_string(differs) + " differs\nfound:    " + shown_list(found) +
                 "\nexpected: " + shown_list(expected),
             caller);
}
template void check_equal(const std::vector<std::string>&, const std::vector<std::string>&,
                          const Caller&);
template void check_equal(const std::vector<double>&, const std::vector<double>&, const Caller&);
template void check_equal(const std::vector<bool>&, const std::vector<bool>&, const Caller&);
template void check_equal(const std::vector<std::uint8_t>&, const std::vector<std::uint8_t>&,
                          const Caller&);
template void check_equal(const std::vector<std::uint32_t>&, const std::vector<std::uint32_t>&,
                          const Caller&);
template void check_equal(const std::vector<std::uint64_t>&, const std::vector<std::uint64_t>&,
                          const Caller&);
template void check_equal(const std::vector<Vec3>&, const std::vector<Vec3>&, const Caller&);

void check_equal(const std::optional<double>& found, double expected, const Caller& caller) {
  if (found) return check_equal(*found, expected, caller);
  fail_check("nothing, expected " + shown(expected), caller);
}
void check_equal(const std::optional<std::uint64_t>& found, std::uint64_t expected,
                 const Caller& caller) {
  if (found) return check_equal(*found, expected, caller);
  fail_check("nothing, expected " + shown(expected), caller);
}

}  // namespace clearway::test
