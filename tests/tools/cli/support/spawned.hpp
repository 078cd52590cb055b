#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace clearway::test {

/// Runs the built program without a shell and returns its peak memory in bytes. Throws where the
/// program fails.
std::uint64_t peak_memory_of(std::vector<std::string> arguments);

}  // namespace clearway::test
