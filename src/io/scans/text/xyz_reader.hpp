#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/progress.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/point_reader.hpp"
#include "io/scans/text/xyz_prologue.hpp"

namespace clearway {

/// Notices, while a text file with one point per line is read, that its last line lacks a line
/// break. Where the file declares its number of points, missing values or digits are refused.
/// Otherwise missing values cause a warning, because the file may be cut.
class OpenEnd {
 public:
  explicit OpenEnd(bool counted = true) : counted_(counted) {}

  /// Called for every line of a point after it was read. input: the text that the line comes from.
  void see(const InputBuffer& input, std::string_view line) {
    if (values_ == 0 || !input.line_terminated()) look(input, line);
  }
  void append_to(std::vector<Message>& remarks, const std::string& name) const;

 private:
  void look(const InputBuffer& input, std::string_view line);

  bool counted_;
  std::size_t values_ = 0;  // number of values in the first line
  std::size_t found_ = 0;   // number of values in the last line, where it lacks a line break
  std::uint64_t line_ = 0;  // number of the last line; 0 where it has a line break
};

/// Reads text with one point per line: x y z and anything after them, separated by blanks, commas
/// or semicolons (one kind within a line, so that decimal commas are refused). Blank lines and
/// lines that start with # or // are comments. The first other line may be the number of points
/// (PTS): exactly that many follow, perhaps then another such number with its points. A header line
/// that names the columns says where x, y and z are; so does a comment that fits the lines.
/// Text without names that looks like something other than points is refused, unless the options
/// choose the columns. `remarks` come before the reader's own. The input must be able to seek.
std::unique_ptr<PointReader> read_xyz(InputBuffer input, const PointReadOptions& options = {},
                                      std::vector<Message> remarks = {});

/// Reads such text from the input's position on, of which everything before is known.
std::unique_ptr<PointReader> read_xyz(InputBuffer input, XyzPrologue prologue);

}  // namespace clearway
