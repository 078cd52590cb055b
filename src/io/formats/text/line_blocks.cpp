#include "io/formats/text/line_blocks.hpp"

#include <algorithm>
#include <span>

namespace clearway {
namespace {

/// Bytes read behind a block to find the end of its last line; a longer line takes a second read.
constexpr std::uint64_t kUsualLine = 1 << 10;

}  // namespace

LineBlocks::LineBlocks(const InputBuffer& input)
    : input_(input), begin_(input.position()), end_(*input.size()) {}

std::string_view LineBlocks::read(std::size_t block, std::vector<char>& room) const {
  const std::uint64_t first = begin_ + block * kBlockBytes;
  const std::uint64_t last = std::min(end_, first + kBlockBytes);
  // Includes the byte before, to see whether a line ends there.
  const std::uint64_t from = block == 0 ? first : first - 1;
  std::uint64_t loaded = from;
  const auto load_to = [&](std::uint64_t to) {
    room.resize(to - from);
    input_.read_at(loaded, std::as_writable_bytes(std::span(room).subspan(loaded - from)));
    loaded = to;
  };
  /// Finds the end of the line to which the byte before `at` belongs.
  const auto line_end = [&](std::uint64_t at) {
    const auto found =
        std::find(room.begin() + static_cast<std::ptrdiff_t>(at - 1 - from), room.end(), '\n');
    return found == room.end() ? std::string_view::npos
                               : static_cast<std::size_t>(found - room.begin()) + 1;
  };
  load_to(std::min(end_, last + kUsualLine));
  std::size_t end = line_end(last);
  if (end == std::string_view::npos && loaded < end_) {
    load_to(std::min(end_, last + InputBuffer::kLongestLine + 1));
    end = line_end(last);
  }
  end = std::min(end, room.size());
  const std::size_t begin = block == 0 ? 0 : std::min(line_end(first), end);
  return {room.data() + begin, end - begin};
}

}  // namespace clearway
