#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/progress.hpp"
#include "io/formats/input_buffer.hpp"

namespace clearway {

/// Notices in one reading of a text with one point per line that its last line lacks a line break.
/// Where the text declares its number of points, this is noted, and refused where values or digits
/// are missing. Otherwise missing values cause a warning, because the text may be cut.
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

}  // namespace clearway
