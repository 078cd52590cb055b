#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// Recognises from the first lines of a text without column names that it is something else than
/// points (docs/design/conversion.md, "Text that is no table of points"). A resemblance must hold
/// on every line examined, so that points pass.
class LookAlike {
 public:
  static constexpr std::size_t kMostLines = 100;

  /// Takes the next line of data, which has no leading blanks.
  void add(std::string_view line);

  /// What the lines look like, for a message; empty for points.
  std::string verdict() const;

 private:
  static constexpr std::size_t kMostNumbers = 20;

  struct Row {
    std::array<double, kMostNumbers> numbers{};
    std::size_t count = 0;  ///< how many numbers the line starts with
    bool whole = false;     ///< whether the line consists of these numbers alone
    /// Whether each of the first two is written as a whole number such as 0, 1 or 2.
    std::array<bool, 2> counting{};
  };

  std::size_t fewest_numbers() const;
  /// How many numbers every line has; 0 where lines differ or hold anything else.
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
