#include "io/system/file_lock.hpp"

#include <fcntl.h>

#include <cerrno>

namespace clearway {

namespace {

struct flock whole_file() {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return whole;
}

}  // namespace

bool lock_whole(const File& file) {
  struct flock whole = whole_file();
  return ::fcntl(file.descriptor(), F_OFD_SETLK, &whole) == 0 ||
         (errno != EAGAIN && errno != EACCES);
}

LockState lock_state(const File& file) {
  struct flock whole = whole_file();
  if (::fcntl(file.descriptor(), F_OFD_GETLK, &whole) != 0) return LockState::kUnknown;
  return whole.l_type == F_UNLCK ? LockState::kFree : LockState::kHeld;
}

}  // namespace clearway
