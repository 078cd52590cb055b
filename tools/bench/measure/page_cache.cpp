#include "bench/measure/page_cache.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "clearway/error.hpp"
#include "io/files/file.hpp"

namespace clearway::bench {

void drop_from_page_cache(const std::filesystem::path& path) {
  const File file = File::open_for_reading(path);
  int error = ::fsync(file.descriptor()) == 0 ? 0 : errno;  // unwritten pages would stay
  if (error == 0) error = ::posix_fadvise(file.descriptor(), 0, 0, POSIX_FADV_DONTNEED);
  if (error == 0) return;
  throw ResourceError(path.string() + ": cannot drop from the page cache: " + std::strerror(error));
}

}  // namespace clearway::bench
