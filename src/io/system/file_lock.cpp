#include "io/system/file_lock.hpp"

#include <fcntl.h>

#include <cerrno>

namespace clearway {

bool lock_whole(const File& file) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return ::fcntl(file.descriptor(), F_OFD_SETLK, &whole) == 0 ||
         (errno != EAGAIN && errno != EACCES);
}

}  // namespace clearway
