#include "io/formats/e57/e57_pages.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <utility>

#include "io/formats/byte_load.hpp"
#include "io/formats/e57/crc32c.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

std::string hexadecimal(std::uint32_t value) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "0x%08X", value);
  return digits;
}

}  // namespace

E57Pages::E57Pages(File file, std::size_t page_bytes)
    : file_(std::move(file)),
      page_(page_bytes),
      content_(page_bytes - kChecksumBytes),
      pages_(file_.size_bytes() / page_bytes),
      window_(std::make_unique<std::byte[]>(kWindowBytes)) {}

std::optional<std::uint64_t> E57Pages::logical(std::uint64_t physical) const {
  if (physical >= pages_ * page_ || physical % page_ >= content_) return std::nullopt;
  return physical / page_ * content_ + physical % page_;
}

void E57Pages::read(std::uint64_t at, std::span<std::byte> out, const char* what) {
  if (at > size() || out.size() > size() - at) {
    refuse_byte(name(), physical(at),
                std::string(what) + " of " + std::to_string(out.size()) +
                    " bytes; expected it to end before the file, which has " +
                    std::to_string(pages_ * page_) + " bytes");
  }
  while (!out.empty()) {
    const std::size_t start = at % content_;
    const auto page = verified_page(at / content_).subspan(start);
    const std::size_t count = std::min(page.size(), out.size());
    std::memcpy(out.data(), page.data(), count);
    out = out.subspan(count);
    at += count;
  }
}

std::span<const std::byte> E57Pages::verified_page(std::uint64_t page) {
  if (page < first_ || page - first_ >= verified_.size()) {
    const std::size_t count = std::min<std::uint64_t>(kWindowBytes / page_, pages_ - page);
    file_.read_at(page * page_, {window_.get(), count * page_});
    first_ = page;
    verified_.assign(count, false);
  }
  const std::size_t index = page - first_;
  const std::byte* bytes = window_.get() + index * page_;
  if (!verified_[index]) {
    const std::uint32_t computed = crc32c({bytes, content_});
    const auto stored = load_swapped<std::uint32_t>(bytes + content_);
    if (computed != stored) {
      refuse_byte(name(), page * page_,
                  "the page of " + std::to_string(page_) + " bytes has checksum " +
                      hexadecimal(computed) + "; expected " + hexadecimal(stored) +
                      " as at its end. The file is damaged: copy or export it again");
    }
    verified_[index] = true;
  }
  return {bytes, content_};
}

}  // namespace clearway
