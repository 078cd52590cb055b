#include "io/formats/text/open_end.hpp"

#include "io/formats/text/point_line.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

constexpr const char* kNoLineBreak = "the file ends without a line break";

std::string missing(std::size_t found, std::size_t values) {
  return kNoLineBreak + (" after " + std::to_string(found)) + " of " + std::to_string(values) +
         " values, so it may be cut";
}

}  // namespace

void OpenEnd::look(const InputBuffer& input, std::string_view line) {
  const std::size_t found = count_fields(line);
  if (values_ == 0) values_ = found;
  if (input.line_terminated()) return;
  found_ = found;
  line_ = input.line();
  if (!counted_) return;
  if (found < values_) {
    refuse_line(input.name(), line_,
                missing(found, values_) + "; expected all values of the last line");
  }
  if (line.ends_with('.')) {
    refuse_line(input.name(), line_,
                std::string(kNoLineBreak) + " within a number; expected all of it");
  }
}

void OpenEnd::append_to(std::vector<Message>& remarks, const std::string& name) const {
  if (line_ == 0) return;
  if (counted_) {
    remarks.push_back({Message::Severity::kNote, "no-line-break", name + ": " + kNoLineBreak, {}});
  } else if (found_ < values_) {
    remarks.push_back({Message::Severity::kWarning,
                       "cut-text",
                       name + ": " + missing(found_, values_),
                       {{"line", static_cast<double>(line_)}}});
  }
}

}  // namespace clearway
