#pragma once

#include <string>
#include <string_view>

#include "io/conflicts/bcf/picture.hpp"
#include "io/conflicts/conflict_file.hpp"

namespace clearway {

/// 8-4-4-4-12 hexadecimal digits that depend on the text alone: a UUID of version 8 (RFC 9562),
/// made of two hashes.
std::string uuid_of(std::string_view text);

/// The ids of a conflict's topic, viewpoint and so on: `what` tells them apart.
std::string conflict_uuid(const ConflictFile& file, const Conflict& conflict,
                          std::string_view what);

std::string bcf_version();
std::string bcf_markup(const ConflictFile& file, const Conflict& conflict);
std::string bcf_viewpoint(const ConflictFile& file, const Conflict& conflict, const Camera& camera);

}  // namespace clearway
