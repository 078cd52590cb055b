#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/progress.hpp"
#include "io/formats/input_buffer.hpp"

namespace clearway {

/// Notices a last line without a line break, of one reading of a text with a point a line. Where
/// the text declares how many points it has, that is noted, and refused where values or digits are
/// missing. Where it does not, missing values are warned of, as the text may be cut.
class OpenEnd {
 public:
  explicit OpenEnd(bool counted = true) : counted_(counted) {}

  /// Every line of a point, after it was read. input: where it comes from.
  void see(const InputBuffer& input, std::string_view line) {
    if (values_ == 0 || !input.line_terminated()) look(input, line);
  }
  void append_to(std::vector<Message>& remarks, const std::string& name) const;

 private:
  void look(const InputBuffer& input, std::string_view line);

  bool counted_;
  std::size_t values_ = 0;  // of the first line
  std::size_t found_ = 0;   // of the last one, where it is open
  std::uint64_t line_ = 0;  // its number; 0: not open
};

}  // namespace clearway
