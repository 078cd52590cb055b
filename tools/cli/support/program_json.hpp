#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <utility>

#include "io/files/json.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway::tool {

/// The object that every report in JSON begins with: "version", of the program, and "files".
Json program_json(std::initializer_list<std::pair<const char*, std::filesystem::path>> files);

/// The files that a store was made of: "name", "bytes", "xxh64", and "first_source" and "points",
/// which say which source indices are theirs and are null where the store does not say.
Json sources_json(const StoreMetadata& store);
/// The corridor of a store: "within", the number of poses of its path, what was left out or not
/// even read, and the box around all points of the scans, "whole".
Json corridor_json(const StoreCorridor& near);
/// The origins of a store: how many are distinct, what they rest on, and how many points have none.
Json origins_json(const StoreOrigins& origins);

}  // namespace clearway::tool
