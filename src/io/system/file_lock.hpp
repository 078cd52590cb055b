#pragma once

#include "io/system/file.hpp"

namespace clearway {

/// Takes the lock of the whole file, which is held until the file is closed. Returns false where
/// another open of the file, in this process or another, has it. On a file system without locks it
/// returns true.
bool lock_whole(const File& file);

enum class LockState { kFree, kHeld, kUnknown };  ///< kUnknown: the file system has no locks

/// Whether another open of the file has its lock. Takes no lock itself.
LockState lock_state(const File& file);

}  // namespace clearway
