#pragma once

#include <string>
#include <vector>

#include "core/util/progress.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// Re-reads and decodes every cell of a store and checks what docs/design/store-format.md promises:
/// hashes, boxes of cells and blocks, padding, and source indices that are unique and in range.
/// Returns the faults found, at most `most`, each naming its cell; none for a sound store.
std::vector<std::string> verify_store(const StoreReader& store, Progress& progress,
                                      std::size_t most = 20);

}  // namespace clearway
