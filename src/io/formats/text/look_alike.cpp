#include "io/formats/text/look_alike.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "io/formats/text/text_number.hpp"

namespace clearway {
namespace {

// Deviation of a norm from 1, as for the poses of a trajectory.
constexpr double kUnitTolerance = 0.01;
constexpr double kFarthestMetres = 1e8;    // greater than any coordinate on Earth
constexpr std::size_t kFewestIndices = 3;  // lines
constexpr std::size_t kFewestTimes = 10;   // lines

bool is_unit(std::span<const double> numbers) {
  double square = 0;
  for (const double n : numbers) square += n * n;
  return std::abs(std::sqrt(square) - 1) <= kUnitTolerance;
}

/// Whether the numbers, in three rows of four or more, begin each row with a row of a rotation.
bool is_rotation(std::span<const double> numbers) {
  const auto at = [&](std::size_t row, std::size_t column) { return numbers[row * 4 + column]; };
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double dot = 0;
      for (std::size_t k = 0; k < 3; ++k) dot += at(i, k) * at(j, k);
      if (!(std::abs(dot - (i == j ? 1 : 0)) <= kUnitTolerance)) return false;
    }
  }
  return true;
}

/// Whether a number is written with digits alone, without point, sign and exponent.
bool is_counting(const char* begin, const char* end) {
  return begin != end && std::all_of(begin, end, [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

void LookAlike::add(std::string_view line) {
  Row row;
  const char* at = line.data();
  const char* const end = at + line.size();
  while (row.count < kMostNumbers) {
    const char* const start = at;
    if (!parse_number(at, end, row.numbers[row.count])) break;
    if (row.count < row.counting.size()) row.counting[row.count] = is_counting(start, at);
    ++row.count;
    if (at == end || skip_separator(at, end) == 0) break;
  }
  row.whole = at == end;
  rows_.push_back(row);
}

std::size_t LookAlike::fewest_numbers() const {
  std::size_t fewest = kMostNumbers;
  for (const Row& row : rows_) fewest = std::min(fewest, row.count);
  return rows_.empty() ? 0 : fewest;
}

std::size_t LookAlike::same_numbers() const {
  const auto like_first = [this](const Row& row) {
    return row.whole && row.count == rows_[0].count;
  };
  return !rows_.empty() && all_rows(like_first) ? rows_[0].count : 0;
}

template <typename Holds>
bool LookAlike::all_rows(Holds holds) const {
  return std::all_of(rows_.begin(), rows_.end(), holds);
}

bool LookAlike::ascending() const {
  return std::adjacent_find(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) {
           return !(a.numbers[0] < b.numbers[0]);
         }) == rows_.end();
}

bool LookAlike::matrices(std::size_t first) const {
  return all_rows(
      [=](const Row& row) { return is_rotation(std::span(row.numbers).subspan(first)); });
}

bool LookAlike::times_and_quaternions() const {
  return rows_.size() > 1 && ascending() &&
         all_rows([](const Row& row) { return is_unit(std::span(row.numbers).subspan(4, 4)); });
}

/// Whether the rows are positions and quaternions. Two layouts of scans that look alike are
/// excluded: a normal with a curvature of 0, and an intensity of 0 with a normal.
bool LookAlike::positions_and_quaternions() const {
  const auto unit = [this](std::size_t first, std::size_t count) {
    return all_rows(
        [=](const Row& row) { return is_unit(std::span(row.numbers).subspan(first, count)); });
  };
  return unit(3, 4) && !unit(3, 3) && !unit(4, 3);
}

/// Whether the first column is an index. A regular grid of points is excluded, whose second column
/// stays the same or counts too.
bool LookAlike::index_first() const {
  if (rows_.size() < kFewestIndices || fewest_numbers() < 4) return false;
  const auto counts = [this](std::size_t column, double step) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double expected = rows_[0].numbers[column] + step * static_cast<double>(i);
      if (!rows_[i].counting[column] || rows_[i].numbers[column] != expected) return false;
    }
    return true;
  };
  return counts(0, 1) && !counts(1, 0) && !counts(1, 1);
}

bool LookAlike::time_first() const {
  if (rows_.size() < kFewestTimes || fewest_numbers() < 4) return false;
  const bool never_back =
      std::is_sorted(rows_.begin(), rows_.end(),
                     [](const Row& a, const Row& b) { return a.numbers[0] < b.numbers[0]; });
  return never_back && all_rows([](const Row& row) {
           return row.numbers[0] > kFarthestMetres && std::abs(row.numbers[1]) < kFarthestMetres &&
                  std::abs(row.numbers[2]) < kFarthestMetres &&
                  std::abs(row.numbers[3]) < kFarthestMetres;
         });
}

std::string LookAlike::verdict() const {
  const std::size_t n = same_numbers();
  // A number may precede or follow each matrix: its index, or its quality.
  for (const std::size_t numbers : {12u, 16u}) {
    if ((n == numbers && matrices(0)) || (n == numbers + 1 && (matrices(0) || matrices(1)))) {
      return "a trajectory (" + std::to_string(n) + " numbers a line, a rigid " +
             (numbers == 12 ? "3 x 4" : "4 x 4") + " matrix)";
    }
  }
  if (n >= 8 && times_and_quaternions()) {
    return "a trajectory (" + std::to_string(n) + " numbers a line: time, position, quaternion)";
  }
  if (n == 7 && positions_and_quaternions()) {
    return "a trajectory (7 numbers a line: position, quaternion)";
  }
  if (index_first()) return "a table whose first column is the point's number";
  if (time_first()) return "a table whose first column is a time";
  return {};
}

}  // namespace clearway
