#pragma once

#include "io/system/file.hpp"

namespace clearway {

/// Takes the lock of the whole file; false where another open of it has it, of this process or
/// another. It is held until the file is closed. A file system without locks goes without.
bool lock_whole(const File& file);

enum class LockState { kFree, kHeld, kUnknown };  ///< kUnknown: a file system without locks

/// Whether another open of the file has its lock. Takes none itself.
LockState lock_state(const File& file);

}  // namespace clearway
