#include "io/formats/e57/e57_header.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <utility>

#include "io/formats/byte_load.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t kLeastPage = 128;
constexpr std::uint64_t kLargestPage = 65536;
static_assert(kLargestPage <= E57Pages::kWindowBytes);

using Header = std::array<std::byte, kE57HeaderBytes>;

Header read_header(const File& file) {
  const std::uint64_t size = file.size_bytes();
  if (size < kE57HeaderBytes) {
    refuse(file.name(), "ends at byte " + std::to_string(size) + "; expected an E57 header of " +
                            std::to_string(kE57HeaderBytes) + " bytes");
  }
  Header header;
  file.read_at(0, header);
  return header;
}

void check_kind(const std::string& name, const Header& header) {
  constexpr std::string_view kSignature = "ASTM-E57";
  if (std::memcmp(header.data(), kSignature.data(), kSignature.size()) != 0) {
    refuse_byte(name, 0, "expected ASTM-E57, the first bytes of an E57 file");
  }
  const auto major = load<std::uint32_t>(header.data() + 8);
  const auto minor = load<std::uint32_t>(header.data() + 12);
  if (major != 1 || minor != 0) {
    refuse_byte(name, 8,
                "E57 version " + std::to_string(major) + "." + std::to_string(minor) +
                    "; expected 1.0. Export the scan as E57 1.0, LAS or PLY");
  }
}

std::size_t page_bytes_of(const std::string& name, const Header& header) {
  const auto page = load<std::uint64_t>(header.data() + 40);
  if (!std::has_single_bit(page) || page < kLeastPage || page > kLargestPage) {
    refuse_byte(name, 40,
                "pages of " + std::to_string(page) +
                    " bytes; expected 1024, or another power of two from " +
                    std::to_string(kLeastPage) + " to " + std::to_string(kLargestPage));
  }
  return page;
}

void check_size(const File& file, const Header& header, std::size_t page) {
  const auto declared = load<std::uint64_t>(header.data() + 16);
  const std::uint64_t size = file.size_bytes();
  if (size != declared) {
    refuse(file.name(), "has " + std::to_string(size) + " bytes; expected " +
                            std::to_string(declared) +
                            " as its header says. Copy or export the file again");
  }
  if (size % page != 0) {
    refuse_byte(file.name(), 16,
                "a file of " + std::to_string(size) + " bytes; expected whole pages of " +
                    std::to_string(page) + " bytes");
  }
}

}  // namespace

E57Container open_e57(File file) {
  Header header = read_header(file);
  check_kind(file.name(), header);
  const std::size_t page = page_bytes_of(file.name(), header);
  check_size(file, header, page);
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
