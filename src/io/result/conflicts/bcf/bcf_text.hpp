#pragma once

#include <string>
#include <string_view>

#include "io/result/conflicts/bcf/picture.hpp"
#include "io/result/conflicts/conflict_file.hpp"

namespace clearway {

/// A UUID of version 8 (RFC 9562) made of two hashes of the text, on which alone it depends.
std::string uuid_of(std::string_view text);

/// The id of a conflict's topic, viewpoint or other part, which `what` distinguishes.
std::string conflict_uuid(const ConflictFile& file, const Conflict& conflict,
                          std::string_view what);

std::string bcf_version();
std::string bcf_markup(const ConflictFile& file, const Conflict& conflict);
std::string bcf_viewpoint(const ConflictFile& file, const Conflict& conflict, const Camera& camera);

}  // namespace clearway
