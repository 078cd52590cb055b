#include <utility>

#include "core/messages/messages.hpp"
#include "io/scans/ptx/ptx_reader.hpp"
#include "io/scans/text/point_blocks.hpp"
#include "io/scans/text/xyz_reader.hpp"

namespace clearway {
namespace {

/// Counts the lines of a single whole number with which the input starts, up to two. Goes back to
/// the start.
int count_lines(InputBuffer& input) {
  const InputBuffer::Mark start = input.mark();
  input.begin_text();
  int found = 0;
  std::string_view line;
  while (found < 2 && next_data_line(input, line) && count_in(line)) ++found;
  input.return_to(start);
  return found;
}

std::vector<Message> named_otherwise(const InputBuffer& input, const char* format,
                                     const char* counts) {
  return {note("named-otherwise",
               input.name() + ": is read as " + format + ", as it starts with " + counts)};
}

}  // namespace

std::unique_ptr<PointReader> read_scan_text(InputBuffer input, bool named_ptx,
                                            const PointReadOptions& options) {
  const int counts = count_lines(input);
  std::vector<Message> remarks;
  if (counts == 2) {
    if (!named_ptx) remarks = named_otherwise(input, "PTX", "two counts");
    return read_ptx(std::move(input), std::move(remarks));
  }
  if (counts == 0 && named_ptx) return read_ptx(std::move(input));
  if (named_ptx) remarks = named_otherwise(input, "PTS", "one count");
  return read_xyz(std::move(input), options, std::move(remarks));
}

}  // namespace clearway
