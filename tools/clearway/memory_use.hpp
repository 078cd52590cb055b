#pragma once

#include <cstdint>

namespace clearway::tool {

/// The largest resident memory of this process without mapped files that any call has seen, bytes.
/// Source: RssAnon of /proc/self/status. 0 where there is none.
std::uint64_t peak_anonymous_bytes();

}  // namespace clearway::tool
