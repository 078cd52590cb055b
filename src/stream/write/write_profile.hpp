#pragma once

#include <optional>
#include <span>

#include "clearway/found_place.hpp"
#include "core/query/profile_set.hpp"
#include "core/util/progress.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// Appends the nearest points of all poses, and returns the nearest of them. chainage: that of
/// every pose, metres. is_part: whether this is a part of a result, for which the squares are
/// written, too. Throws InputError for a damaged cell, ResourceError for a full disk, Interrupted
/// when the progress asks to stop.
std::optional<FoundPlace> write_profile(const StoreReader& store, const ProfileSet& profile,
                                        std::span<const double> chainage, bool is_part,
                                        ResultWriter& writer, Progress& progress);

}  // namespace clearway
