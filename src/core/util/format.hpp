#pragma once

#include <cstdint>
#include <string>

namespace clearway {

/// "1.5 GiB", for messages.
std::string format_size(std::uint64_t bytes);

/// "78,439", for messages.
std::string format_count(std::uint64_t count);

}  // namespace clearway
