#pragma once

#include "io/formats/e57/e57_scan.hpp"
#include "io/formats/e57/e57_xml.hpp"

namespace clearway {

/// Reads from the element `points` which bytestreams a scan has and which of them hold coordinates.
/// Fields of extensions count as bytestreams and are not read.
void read_e57_prototype(const E57Xml& xml, pugi::xml_node points, E57Scan& scan);

}  // namespace clearway
