#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// Tells from the first lines of a text without names of columns whether it is something else than
/// points (docs/design/conversion.md, "Text that is no table of points"). What it is taken for must
/// hold on every line looked at, so that points pass.
class LookAlike {
 public:
  static constexpr std::size_t kMostLines = 100;

  /// The next line of data, without leading blanks.
  void add(std::string_view line);

  /// What the lines look like, for a message; empty for points.
  std::string verdict() const;

 private:
  static constexpr std::size_t kMostNumbers = 20;

  struct Row {
    std::array<double, kMostNumbers> numbers{};
    std::size_t count = 0;           ///< numbers at the line's start
    bool whole = false;              ///< the line is nothing but these
    std::array<bool, 2> counting{};  ///< the first two are written as 0, 1, 2, ...
  };

  std::size_t fewest_numbers() const;
  /// The number of numbers of every line; 0 where lines differ or hold anything else.
  std::size_t same_numbers() const;
  template <typename Holds>
  bool all_rows(Holds holds) const;
  bool ascending() const;
  bool matrices(std::size_t first) const;
  bool times_and_quaternions() const;
  bool positions_and_quaternions() const;
  bool index_first() const;
  bool time_first() const;

  std::vector<Row> rows_;
};

}  // namespace clearway
