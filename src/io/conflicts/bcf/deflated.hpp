#pragma once

#include <string>
#include <string_view>

namespace clearway {

enum class DeflateForm { kRaw, kZlib };  ///< without or with zlib's header and checksum

/// The bytes compressed by zlib. Throws std::bad_alloc. Source: RFC 1951, RFC 1950.
std::string deflated(std::string_view bytes, DeflateForm form);

}  // namespace clearway
