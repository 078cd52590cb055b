#pragma once

#include <filesystem>

namespace clearway::bench {

/// Drops a file from the page cache of the system, so that the next reader waits for the disk.
/// Throws ResourceError.
void drop_from_page_cache(const std::filesystem::path& path);

}  // namespace clearway::bench
