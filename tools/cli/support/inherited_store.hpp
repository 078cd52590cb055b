#pragma once

#include <filesystem>

#include "clearway/store.hpp"

/// The store that a process has opened for the commands that it forks, so that each of them need
/// not read the store's index again. The children share its memory until they write there.
namespace clearway::tool {

/// Opens the store that a command asks about, in the place of an earlier one, unless it is open
/// already. Starts no thread. Where the store cannot be opened, nothing is kept, because the
/// command itself says why.
void keep_store(const std::filesystem::path& path);

/// Opens a store, or takes the one that is open, once, where its file is still the same. Throws as
/// Store() does.
Store open_store(const std::filesystem::path& path);

}  // namespace clearway::tool
