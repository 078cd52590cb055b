#pragma once

#include <nlohmann/json.hpp>

#include "io/store/store_metadata.hpp"

namespace clearway::tool {

/// The files that a store was made of: "name", "bytes", "xxh64", and "first_source" and "points",
/// which say which source indices are theirs and are null where the store does not tell.
nlohmann::ordered_json sources_json(const StoreMetadata& store);

}  // namespace clearway::tool
