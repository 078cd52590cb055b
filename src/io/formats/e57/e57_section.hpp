#pragma once

#include <cstdint>

#include "io/formats/e57/e57_pages.hpp"
#include "io/formats/e57/e57_scan.hpp"

namespace clearway {

/// Logical positions of a scan's binary section.
struct E57Extent {
  std::uint64_t start = 0;
  std::uint64_t packets = 0;  ///< start of the first packet
  std::uint64_t end = 0;

  std::uint64_t packet_bytes() const { return end - packets; }
};

/// Reads the header of a scan's binary section. Compares it with the file and with the scan's
/// number of records, for which the packets must have room. A scan without records may lack a
/// section; its extent is empty. Throws InputError.
E57Extent find_e57_section(E57Pages& pages, const E57Scan& scan);

}  // namespace clearway
