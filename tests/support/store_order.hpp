#pragma once

#include <span>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "io/store/store_reader.hpp"
#include "support/store_fixture.hpp"

namespace clearway::test {

/// Puts a bucket's points into the store's order (docs/design/store-format.md, "Order of the
/// points"), as plainly as that can be written: it sorts by (coordinate, source) on the longest
/// side, cuts, and does the same with both parts.
void order_plainly(std::span<StoredPoint> points, std::uint64_t cell_points,
                   const Quantisation& quantisation);

/// Checks what docs/design/store-format.md promises of every store except the order inside a
/// bucket: full cells but a bucket's last, buckets of at most 2^21 points, parts on either side of
/// a plane (or, at one place, of a source index), boxes that hold. Returns each fault as a
/// sentence.
std::vector<std::string> structure_faults(const StoreReader& store);

}  // namespace clearway::test
