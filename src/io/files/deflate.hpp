#pragma once

#include <string>
#include <string_view>

namespace clearway {

enum class DeflateForm { kRaw, kZlib };  ///< without or with zlib's header and checksum

/// The bytes compressed by zlib. level: from 1 to 9; -1: zlib's own choice. Throws std::bad_alloc.
/// Source: RFC 1951, RFC 1950.
std::string deflated(std::string_view bytes, DeflateForm form, int level = -1);

}  // namespace clearway
