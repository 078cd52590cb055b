#include "clearway/bench/work_folder.hpp"

#include <fcntl.h>

#include <cerrno>
#include <cstring>

#include "core/error.hpp"
#include "io/file_lock.hpp"

namespace clearway::tool {
namespace {

namespace fs = std::filesystem;

fs::path made(fs::path path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) {
    throw ResourceError(path.string() + ": cannot create the folder: " + error.message());
  }
  return path;
}

/// The lock's file stays: removing it would let another process lock one without a name.
File locked(const fs::path& folder) {
  const fs::path path = folder / "bench.lock";
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    throw ResourceError(path.string() + ": cannot create: " + std::strerror(errno));
  }
  File file = File::adopt(descriptor, path.string());
  if (!lock_whole(file)) {
    throw ResourceError(folder.string() +
                        ": another bench uses it; wait for it, or take another --work");
  }
  return file;
}

}  // namespace

WorkFolder::WorkFolder(fs::path path) : path_(made(std::move(path))), lock_(locked(path_)) {}

}  // namespace clearway::tool
