#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"
#include "io/formats/input_buffer.hpp"

/// The lines that PTX and PTS consist of.
namespace clearway {

/// What the first lines of a text with points say of it.
enum class CountLines {
  kNone,  ///< no count: XYZ
  kOne,   ///< the number of points: PTS
  kTwo,   ///< columns and rows of a scan: PTX
};

/// Looks at the start of the input and goes back to it. Throws InputError for a line that is too
/// long.
CountLines find_count_lines(InputBuffer& input);

/// The next line that is neither blank nor a comment (# or //), without blanks around it; false at
/// the end.
bool next_scan_line(InputBuffer& input, std::string_view& line);

/// A line of nothing but a whole number from 0.
std::optional<std::uint64_t> count_in(std::string_view line);

/// At most as many points can stand in the rest of the input: each takes a line.
std::uint64_t most_scan_points(const InputBuffer& input);

/// x y z and anything behind them, in blanks, commas or semicolons; false for anything else.
bool parse_scan_point(std::string_view line, Vec3& point);

/// Notices a last line without a line break: notes it, and refuses where values or digits are
/// missing, so that the file is cut. Of one reading of a file.
class OpenEnd {
 public:
  /// Every line of a point, after it was read. input: where it comes from.
  void see(const InputBuffer& input, std::string_view line) {
    if (values_ == 0 || !input.line_terminated()) look(input, line);
  }
  void append_to(std::vector<Message>& remarks, const std::string& name) const;

 private:
  void look(const InputBuffer& input, std::string_view line);

  std::size_t values_ = 0;  // of the first line
  bool open_ = false;
};

}  // namespace clearway
