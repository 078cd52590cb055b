#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "support/compare.hpp"

namespace clearway::test {

/// Checks that a JSON value has what `expected` says, which is JSON too. An object has to have the
/// members that are named, with these values; it may have others. Everything else has to be equal.
/// An element of a list is named by its index: {"bodies": {"0": {"name": "front"}}}.
void check_json(const nlohmann::json& value, std::string_view expected,
                const Caller& caller = Caller::current());
/// The same of a text, which has to be JSON.
void check_json_text(const std::string& text, std::string_view expected,
                     const Caller& caller = Caller::current());

/// Checks the number at a JSON pointer, such as "/bodies/0/radius".
void check_near(const nlohmann::json& value, std::string_view pointer, double expected,
                double tolerance, const Caller& caller = Caller::current());
/// The same with a tolerance of a hundred thousandth of `expected`.
void check_near(const nlohmann::json& value, std::string_view pointer, double expected,
                const Caller& caller = Caller::current());

}  // namespace clearway::test
