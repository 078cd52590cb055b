#pragma once

#include <cstdint>

#include "io/formats/e57/e57_pages.hpp"
#include "io/formats/e57/e57_scan.hpp"

namespace clearway {

/// Where a scan's binary section lies: logical positions.
struct E57Extent {
  std::uint64_t start = 0;
  std::uint64_t packets = 0;  ///< the first one's start
  std::uint64_t end = 0;

  std::uint64_t packet_bytes() const { return end - packets; }
};

/// Reads the section's header and compares it with the file and with the scan's count of records,
/// which its packets must have room for. A scan without records may lack a section: empty extent.
/// Throws InputError.
E57Extent find_e57_section(E57Pages& pages, const E57Scan& scan);

}  // namespace clearway
