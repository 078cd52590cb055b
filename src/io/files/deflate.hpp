#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace clearway {

enum class DeflateForm { kRaw, kZlib };  ///< without or with zlib's header and checksum

/// The bytes compressed by zlib. level: from 1 to 9; -1: zlib's own choice. Throws std::bad_alloc.
/// Source: RFC 1951, RFC 1950.
std::string deflated(std::string_view bytes, DeflateForm form, int level = -1);

/// The bytes compressed by zlib in zlib's form, in blocks of kDeflateBlock bytes that many threads
/// compress at the same time. Each block may refer to what is before it, as in one stream, so this
/// takes 5 more bytes a block. Up to one block gives the bytes of deflated(). The result is the
/// same for any number of threads. Runs in the caller's arena of oneTBB. Throws std::bad_alloc.
std::string deflated_in_blocks(std::string_view bytes, int level);

inline constexpr std::size_t kDeflateBlock = std::size_t{1} << 18;

}  // namespace clearway
