#include <utility>

#include "io/formats/ptx/ptx_reader.hpp"
#include "io/formats/ptx/scan_lines.hpp"
#include "io/formats/text/xyz_reader.hpp"

namespace clearway {
namespace {

std::vector<Message> named_otherwise(const InputBuffer& input, const char* format,
                                     const char* counts) {
  return {{Message::Severity::kNote, "named-otherwise",
           input.name() + ": is read as " + format + ", as it starts with " + counts}};
}

}  // namespace

std::unique_ptr<PointReader> read_scan_text(InputBuffer input, TextEnding ending,
                                            const PointReadOptions& options) {
  const CountLines counts = find_count_lines(input);
  std::vector<Message> remarks;
  if (counts == CountLines::kTwo) {
    if (ending != TextEnding::kPtx) remarks = named_otherwise(input, "PTX", "two counts");
    return read_ptx(std::move(input), std::move(remarks));
  }
  if (counts == CountLines::kOne && ending != TextEnding::kXyz) {
    if (ending == TextEnding::kPtx) remarks = named_otherwise(input, "PTS", "one count");
    return read_pts(std::move(input), std::move(remarks));
  }
  return ending == TextEnding::kPtx ? read_ptx(std::move(input))
                                    : read_xyz(std::move(input), options);
}

}  // namespace clearway
