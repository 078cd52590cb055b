#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/files/text_lines.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {

/// Divides the rest of a text file into blocks of lines that can be read at the same time. A line
/// belongs to the block in which it begins.
class LineBlocks {
 public:
  static constexpr std::size_t kBlockBytes = std::size_t{1} << 18;  ///< fits in L2

  /// input: can seek, stands at the start of a line, and outlives this object.
  explicit LineBlocks(const InputBuffer& input);

  std::size_t count() const { return (end_ - begin_ + kBlockBytes - 1) / kBlockBytes; }

  /// The lines of a block; the last may lack its line break. `room` holds the text. May be called
  /// from several threads at once. A line that is too long is cut, but remains longer than allowed.
  std::string_view read(std::size_t block, std::vector<char>& room) const;

 private:
  const InputBuffer& input_;
  std::uint64_t begin_, end_;  ///< range of bytes in the file
};

/// Calls use(line) for the lines of a block, in the form of InputBuffer::next_line(), until it
/// returns false. Returns false in that case and for a line that is too long.
template <typename Use>
bool each_line(std::string_view block, Use use) {
  while (!block.empty()) {
    const std::string_view line = take_line(block);
    if (line.size() > InputBuffer::kLongestLine || !use(line)) return false;
  }
  return true;
}

inline constexpr CoordinateColumns kFirstThree{0, 1, 2};

/// Parses lines of a text file, given the columns of x, y and z and their separator.
class PointLine {
 public:
  PointLine() = default;
  /// separator: ',', ';' or ' '.
  PointLine(const CoordinateColumns& columns, char separator)
      : columns_(columns), separator_(separator) {}

  const CoordinateColumns& columns() const { return columns_; }
  /// Parses a line without leading blanks; returns false where it is anything other than a point.
  bool parse(std::string_view line, Vec3& point);

 private:
  CoordinateColumns columns_ = kFirstThree;
  char separator_ = ' ';  ///< separator; not used for the first three columns
  std::vector<std::string_view> fields_;
};

/// Parses x, y and z in the first three columns, followed by anything, separated by blanks, commas
/// or semicolons. Returns false for anything else. line: without leading blanks.
bool parse_point(std::string_view line, Vec3& point);

/// The value of a line that is nothing but a whole number from 0. line: without leading blanks.
std::optional<std::uint64_t> count_in(std::string_view line);

/// Upper bound on the number of points in the rest of the input, as each takes a line.
std::uint64_t most_points_in_rest(const InputBuffer& input);

/// The line number of each of `points`, which are ascending numbers counted from 0. next_point:
/// advances the input, which stands before the first point, by one point; returns false at the end.
template <typename NextPoint>
std::vector<std::uint64_t> lines_of_points(std::span<const std::uint64_t> points,
                                           const InputBuffer& input, NextPoint next_point) {
  std::vector<std::uint64_t> lines;
  for (std::uint64_t i = 0; lines.size() < points.size() && next_point(); ++i) {
    if (i == points[lines.size()]) lines.push_back(input.line());
  }
  return lines;
}

std::string_view without_leading_blanks(std::string_view line);

/// Whether a line is blank or starts with # or //. line: without leading blanks.
bool is_text_comment(std::string_view line);

/// Reads the next line that is neither blank nor a comment, without leading blanks; returns false
/// at the end.
bool next_data_line(InputBuffer& input, std::string_view& line);

/// The separator of the fields of a line of data: ',', ';' or ' ' for any blanks.
char separator_of(std::string_view line);

/// The number of fields of a line, separated by separator_of(line).
std::size_t count_fields(std::string_view line);

/// For the message about a refused line: half a sentence where its numbers have decimal commas,
/// otherwise empty.
std::string decimal_commas_in(std::string_view line);

/// Reads the points of a text file ahead, several blocks of lines at the same time. It accepts only
/// whole lines that certainly are points or hold nothing. Everything else stays in the input for a
/// reader that goes line by line and can report what is wrong.
class PointLineBlocks {
 public:
  enum class Line {
    kPoint,
    kNothing,  ///< a blank line or a comment
    kOther
  };

  /// Parses the points of a block's lines; returns false for a line of another kind.
  using ParseBlock = std::function<bool(std::string_view block, std::vector<Vec3>& points)>;

  /// Makes a ParseBlock of parse(line, point), which returns the kind of a line. It is copied for
  /// each block.
  template <typename Parse>
  static ParseBlock of_lines(const Parse& parse) {
    return [parse](std::string_view block, std::vector<Vec3>& points) {
      Parse own = parse;
      return each_line(block, [&](std::string_view line) {
        Vec3 point{};
        const Line kind = own(line, point);
        if (kind == Line::kPoint) points.push_back(point);
        return kind != Line::kOther;
      });
    };
  }

  /// Reads on from the input's position and moves it past what was read. Returns the number of
  /// points; nullopt, with the input where it was, if nothing could be read. most: number of points
  /// that may follow.
  std::optional<std::uint64_t> read(InputBuffer& input, const ParseBlock& parse,
                                    std::uint64_t most);
  /// Appends points that were read to `out`, until it has `size`. Returns how many were appended.
  std::size_t take(std::vector<Vec3>& out, std::size_t size);
  void clear() { parts_.clear(); }

 private:
  struct Part {
    std::vector<Vec3> points;
    std::uint64_t bytes = 0, lines = 0;  ///< length of the part in the text
    bool good = false;
  };

  std::vector<Part> parts_;
  std::size_t part_ = 0, point_ = 0;  ///< indices of the next point to be taken
};

}  // namespace clearway
