#include "support/compare_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

using nlohmann::json;

namespace clearway::test {

namespace {

/// What a value at `place` lacks of `expected`, a line for each difference.
std::string differences(const json& value, const json& expected, const std::string& place) {
  std::string found;
  if (expected.is_object() && value.is_structured()) {
    for (const auto& [key, member] : expected.items()) {
      const std::string inside = place + "/" + key;
      const json::json_pointer pointer("/" + key);
      found += value.contains(pointer) ? differences(value[pointer], member, inside)
                                       : inside + " is missing, expected " + member.dump() + "\n";
    }
  } else if (expected.is_array() && value.is_array() && expected.size() == value.size()) {
    for (std::size_t i = 0; i < expected.size(); ++i) {
      found += differences(value[i], expected[i], place + "/" + std::to_string(i));
    }
  } else if (value != expected) {
    found = place + " is " + value.dump() + ", expected " + expected.dump() + "\n";
  }
  return found;
}

}  // namespace

void check_json(const json& value, std::string_view expected, const Caller& caller) {
  const std::string found = differences(value, json::parse(expected), "");
  if (found.empty()) {
    SUCCEED();
  } else {
    fail_check(found, caller);
  }
}

void check_json_text(const std::string& text, std::string_view expected, const Caller& caller) {
  const json value = json::parse(text, nullptr, false);
  if (value.is_discarded()) {
    fail_check("found:    " + text + "\nexpected: JSON", caller);
  } else {
    check_json(value, expected, caller);
  }
}

void check_near(const json& value, std::string_view pointer, double expected, double tolerance,
                const Caller& caller) {
  const json::json_pointer place{std::string(pointer)};
  if (value.contains(place) && value[place].is_number()) {
    check_near(value[place].get<double>(), expected, tolerance, caller);
  } else {
    fail_check("no number at " + std::string(pointer) + " of " + value.dump(), caller);
  }
}

void check_near(const json& value, std::string_view pointer, double expected,
                const Caller& caller) {
  check_near(value, pointer, expected, 1e-5 * std::abs(expected), caller);
}

}  // namespace clearway::test
