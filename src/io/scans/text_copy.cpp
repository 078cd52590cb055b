#include "io/scans/text_copy.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "io/files/input_error.hpp"

namespace clearway {
namespace {

constexpr std::byte kLineFeed{'\n'}, kReturn{'\r'};

}  // namespace

void LineFeeds::add(std::span<const std::byte> bytes) {
  for (const std::byte byte : bytes) {
    if (byte == kLineFeed) ++(last_ == kReturn ? pairs_ : alone_);
    last_ = byte;
  }
}

void refuse_text_copy(const std::string& name) {
  refuse(name,
         "was copied as text, as FTP does in ASCII mode: each LF in it follows a CR, so bytes were "
         "put in. Copy the original again as a binary file");
}

void refuse_if_copied_as_text(const File& file, std::uint64_t from) {
  constexpr std::uint64_t kWindow = std::uint64_t{1} << 18;
  std::vector<std::byte> window(kWindow);
  LineFeeds feeds;
  const std::uint64_t size = file.size_bytes();
  for (std::uint64_t at = from; at < size && !feeds.has_lone(); at += kWindow) {
    const auto bytes = std::span(window).first(std::min(kWindow, size - at));
    file.read_at(at, bytes);
    feeds.add(bytes);
  }
  if (feeds.are_all_pairs()) refuse_text_copy(file.name());
}

void refuse_if_copied_as_text(const InputBuffer& input) {
  const std::uint64_t begin = input.position();
  std::array<std::byte, 2> before{};
  if (begin < before.size()) return;
  input.read_at(begin - before.size(), before);
  if (before == std::array{kReturn, kLineFeed}) refuse_if_copied_as_text(input.file(), begin);
}

void refuse_seven_bits(InputBuffer& input) {
  // So many bytes other than zero, with so many values, hold a greater one in any binary data.
  // Coordinates that are small whole numbers have only few values.
  constexpr std::size_t kWindow = std::size_t{1} << 16;
  constexpr std::size_t kEnough = 4096, kEnoughValues = 96;
  const auto bytes = input.peek(kWindow);
  const auto is_high = [](std::byte byte) { return byte > std::byte{0x7F}; };
  const auto zeros = static_cast<std::size_t>(std::ranges::count(bytes, std::byte{0}));
  if (bytes.size() - zeros < kEnough || std::ranges::any_of(bytes, is_high)) return;
  std::array<bool, 128> found{};
  for (const std::byte byte : bytes) found[std::to_integer<std::size_t>(byte)] = true;
  if (static_cast<std::size_t>(std::ranges::count(found, true)) < kEnoughValues) return;
  refuse(input.name(),
         "has no byte above 127, so a program that takes it for text cut off the highest bits. "
         "Copy the original again as a binary file");
}

}  // namespace clearway
