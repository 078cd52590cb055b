#include "io/scans/e57/e57_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <cstring>
#include <utility>

#include "io/files/bytes.hpp"
#include "io/scans/formatted_message.hpp"

#if defined(__x86_64__)
#include <nmmintrin.h>
#endif

namespace clearway {
namespace {

/// What each byte adds to a remainder.
constexpr std::array<std::uint32_t, 256> kTable = [] {
  constexpr std::uint32_t kReflectedPolynomial = 0x82F63B78;
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t b = 0; b < 256; ++b) {
    table[b] = b;
    for (int bit = 0; bit < 8; ++bit) {
      table[b] = (table[b] >> 1) ^ ((table[b] & 1) != 0 ? kReflectedPolynomial : 0);
    }
  }
  return table;
}();

#if defined(__x86_64__)
__attribute__((target("sse4.2"))) std::uint32_t crc32c_by_instruction(
    std::span<const std::byte> bytes) {
  std::uint64_t remainder = 0xFFFFFFFF;
  const std::byte* at = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= 8; left -= 8, at += 8)
    remainder = _mm_crc32_u64(remainder, load<std::uint64_t>(at));
  auto narrow = static_cast<std::uint32_t>(remainder);
  for (; left > 0; --left, ++at) narrow = _mm_crc32_u8(narrow, load<std::uint8_t>(at));
  return ~narrow;
}
#endif

}  // namespace

std::uint32_t crc32c_by_table(std::span<const std::byte> bytes) {
  std::uint32_t remainder = 0xFFFFFFFF;
  for (const std::byte byte : bytes) {
    remainder =
        (remainder >> 8) ^ kTable[(remainder ^ std::to_integer<std::uint32_t>(byte)) & 0xFF];
  }
  return ~remainder;
}

std::uint32_t crc32c(std::span<const std::byte> bytes) {
#if defined(__x86_64__)
  static const bool has_instruction = __builtin_cpu_supports("sse4.2") != 0;
  if (has_instruction) return crc32c_by_instruction(bytes);
#endif
  return crc32c_by_table(bytes);
}

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
                "{} of {} bytes; expected it to end before the file, which has {} bytes", what,
                out.size(), pages_ * page_);
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

namespace {

constexpr std::uint64_t kLeastPage = 128;
constexpr std::uint64_t kLargestPage = 65536;
static_assert(kLargestPage <= E57Pages::kWindowBytes);

/// Throws InputError unless the header of a file is one of E57 1.0 and fits the file's size.
void check_header(const File& file, const std::byte* header) {
  constexpr std::string_view kSignature = "ASTM-E57";
  const std::string& name = file.name();
  const auto number = [&](std::size_t at) { return load<std::uint64_t>(header + at); };
  if (std::memcmp(header, kSignature.data(), kSignature.size()) != 0) {
    refuse_byte(name, 0, "expected ASTM-E57, the first bytes of an E57 file");
  }
  const auto major = load<std::uint32_t>(header + 8), minor = load<std::uint32_t>(header + 12);
  if (major != 1 || minor != 0) {
    refuse_byte(name, 8, "E57 version {}.{}; expected 1.0. Export the scan as E57 1.0, LAS or PLY",
                major, minor);
  }
  const std::uint64_t page = number(40), declared = number(16), size = file.size_bytes();
  if (!std::has_single_bit(page) || page < kLeastPage || page > kLargestPage) {
    refuse_byte(name, 40, "pages of {} bytes; expected 1024, or another power of two from {} to {}",
                page, kLeastPage, kLargestPage);
  }
  if (size != declared) {
    refuse(name, "has " + std::to_string(size) + " bytes; expected " + std::to_string(declared) +
                     " as its header says. Copy or export the file again");
  }
  if (size % page != 0) {
    refuse_byte(name, 16, "a file of {} bytes; expected whole pages of {} bytes", size, page);
  }
}

}  // namespace

E57Container open_e57(File file) {
  std::array<std::byte, kE57HeaderBytes> header;
  if (file.size_bytes() < header.size()) {
    refuse(file.name(), "ends at byte {}; expected an E57 header of {} bytes", file.size_bytes(),
           header.size());
  }
  file.read_at(0, header);
  check_header(file, header.data());
  const auto page = load<std::uint64_t>(header.data() + 40);
  E57Pages pages(std::move(file), page);
  pages.read(0, header, "the header");  // read again, verified by the page's checksum
  const auto xml_offset = load<std::uint64_t>(header.data() + 24);
  const auto xml_start = pages.logical(xml_offset);
  if (!xml_start || *xml_start < kE57HeaderBytes) {
    refuse_byte(pages.name(), 24,
                "the XML section is at byte " + std::to_string(xml_offset) +
                    "; expected a place behind the header, within the file and in no checksum");
  }
  return {std::move(pages), *xml_start, load<std::uint64_t>(header.data() + 32)};
}

}  // namespace clearway
