#pragma once

#include <span>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "io/store/store_reader.hpp"
#include "support/store_fixture.hpp"

namespace clearway::test {

/// The store's order of a bucket's points (docs/design/store-format.md, "Order"), as plainly as it
/// can be written: sort by (coordinate, source) on the longest side, cut, and the same with both
/// parts.
void order_plainly(std::span<StoredPoint> points, std::uint64_t cell_points,
                   const Quantisation& quantisation);

/// What docs/design/store-format.md promises of every store but the order inside a bucket: full
/// cells but a bucket's last, buckets of at most 2^21 points, parts on either side of a plane (or,
/// at one place, of a source index), boxes that hold. Each fault as a sentence.
std::vector<std::string> structure_faults(const StoreReader& store);

}  // namespace clearway::test
