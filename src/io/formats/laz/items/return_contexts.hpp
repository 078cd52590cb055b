#pragma once

#include <array>
#include <cstdint>
#include <string_view>

/// LAZ chooses the models of a point's coordinates by its return number and the pulse's number of
/// returns. The tables are facts of the format: docs/design/laz.md.
namespace clearway::laz {

template <unsigned kSize>
using ReturnTable = std::array<std::array<std::uint8_t, kSize>, kSize>;

/// rows: one line for each number of returns, with one hexadecimal digit for each return number.
template <unsigned kSize>
constexpr ReturnTable<kSize> return_table(std::string_view rows) {
  ReturnTable<kSize> table{};
  for (unsigned i = 0; i < kSize * kSize; ++i) {
    const char digit = rows[i];
    table[i / kSize][i % kSize] =
        static_cast<std::uint8_t>(digit <= '9' ? digit - '0' : digit - 'a' + 10);
  }
  return table;
}

/// The table of point formats 0 to 5.
constexpr ReturnTable<8> kReturnMap10 = return_table<8>(
    "fedcba98"
    "e0136aa9"
    "d1247bba"
    "c3458ccb"
    "b6789ddc"
    "aabcdeed"
    "9abcdefe"
    "89abcdef");

/// The table of point formats 6 to 10.
constexpr ReturnTable<16> kReturnMap14 = return_table<16>(
    "0123453445555555"
    "1013333333333333"
    "2124444444433333"
    "3345444444444444"
    "4344544444444444"
    "5344454444444444"
    "3344445444444444"
    "4344444544444444"
    "4344444454444444"
    "5344444445444444"
    "5344444444544444"
    "5334444444455444"
    "5334444444455544"
    "5334444444445554"
    "5334444444444555"
    "5334444444444455");

/// The depth of a return, up to 7: the number of returns behind it, or for wrong numbers by how
/// much the return number exceeds the number of returns.
constexpr unsigned return_level(unsigned returns, unsigned number) {
  const unsigned level = returns < number ? number - returns : returns - number;
  return level < 7 ? level : 7;
}

}  // namespace clearway::laz
