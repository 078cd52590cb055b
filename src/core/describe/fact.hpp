#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <tuple>

namespace clearway {

/// The declaration of this function, which names the member that it is made for.
template <auto kMember>
consteval std::string_view declaration_of_member() {
  return __PRETTY_FUNCTION__;
}

/// The name of a member of a struct, as a text that ends with a zero.
template <auto kMember>
inline constexpr auto kNameOfMember = [] {
  constexpr std::string_view text = declaration_of_member<kMember>();
  constexpr std::size_t start = text.find("kMember = &");
  constexpr std::string_view member = text.substr(start, text.find_first_of(";]", start) - start);
  constexpr std::string_view name = member.substr(member.rfind(':') + 1);
  std::array<char, name.size() + 1> chars{};
  for (std::size_t i = 0; i < name.size(); ++i) chars[i] = name[i];
  return chars;
}();

/// A member of a report, or a function of it without arguments, under its own name unless another
/// one is given. for_each_field() visits the facts of a list.
template <auto kMember>
struct Fact {
  static constexpr auto member = kMember;
  const char* doc;  ///< documentation in Python
  const char* key;  ///< name in Python
};

template <auto kMember>
constexpr Fact<kMember> fact(const char* doc, const char* key = kNameOfMember<kMember>.data()) {
  return {doc, key};
}

/// The facts of a report in their order, for JSON and Python; specialised where they are described.
template <typename Report>
inline constexpr std::tuple<> kFactsOf{};

}  // namespace clearway
