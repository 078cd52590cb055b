#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/files/file.hpp"

namespace clearway {

/// CRC-32C (Castagnoli) of the bytes: polynomial 0x1EDC6F41, bits reflected, start and end
/// inverted. Uses the processor's instruction where there is one. Source: RFC 3720, section 12.1
/// and appendix B.4.
std::uint32_t crc32c(std::span<const std::byte> bytes);

/// CRC-32C computed by tables, on any processor.
std::uint32_t crc32c_by_table(std::span<const std::byte> bytes);

/// The content of an E57 file: its pages without the checksum at the end of each. A page's checksum
/// is verified before a byte of the page is given. A position in the content is called logical, one
/// in the file physical; both count bytes from 0.
class E57Pages {
 public:
  static constexpr std::size_t kChecksumBytes = 4;

  /// page_bytes: at most kWindowBytes. The file must consist of whole pages.
  E57Pages(File file, std::size_t page_bytes);

  const std::string& name() const { return file_.name(); }
  /// Size of the content in bytes.
  std::uint64_t size() const { return pages_ * content_; }
  std::uint64_t physical(std::uint64_t logical) const {
    return logical / content_ * page_ + logical % content_;
  }
  /// The logical position; nullopt after the end of the file and within a checksum.
  std::optional<std::uint64_t> logical(std::uint64_t physical) const;

  /// Copies the content from the logical position `at`. what: names the content in the message
  /// where the file ends too early, as in "the XML section".
  void read(std::uint64_t at, std::span<std::byte> out, const char* what);

  /// Bytes read from the file at once.
  static constexpr std::size_t kWindowBytes = std::size_t{1} << 17;

 private:
  /// The content of a page, whose checksum has been verified.
  std::span<const std::byte> verified_page(std::uint64_t page);

  File file_;
  std::size_t page_;     ///< bytes of a page
  std::size_t content_;  ///< bytes of a page without its checksum
  std::uint64_t pages_;
  std::unique_ptr<std::byte[]> window_;
  std::uint64_t first_ = 0;     ///< first page in the window
  std::vector<bool> verified_;  ///< whether each page in the window is verified
};

/// An E57 file as its first 48 bytes describe it.
struct E57Container {
  E57Pages pages;
  std::uint64_t xml_start;  ///< logical position of the XML section
  std::uint64_t xml_bytes;
};

inline constexpr std::uint64_t kE57HeaderBytes = 48;

/// Opens an E57 file and checks its header against the file's size. Throws InputError.
E57Container open_e57(File file);

}  // namespace clearway
