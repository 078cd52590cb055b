#pragma once

#include "io/formats/e57/e57_pages.hpp"

namespace clearway {

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
