#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace clearway::test {

/// Runs the built program without a shell; gives the most memory it had at a time, in bytes. Throws
/// where it fails.
std::uint64_t peak_memory_of(std::vector<std::string> arguments);

}  // namespace clearway::test
