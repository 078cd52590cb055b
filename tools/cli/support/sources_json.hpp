#pragma once

#include <nlohmann/json.hpp>

#include "io/store/store_metadata.hpp"

namespace clearway::tool {

/// The files that a store was made of: "name", "bytes", "xxh64", and which source indices are
/// theirs: "first_source" and "points"; both null where the store does not say.
nlohmann::ordered_json sources_json(const StoreMetadata& store);

}  // namespace clearway::tool
