// Preloaded into the program: lets calls on the files of one folder go wrong.
//   FAULT_FOLDER  the folder, with a slash at its end
//   FAULT_KIND    fail: EIO for reading, ENOSPC for everything else
//                 short: half of what was asked for
//                 interrupt: EINTR, every other time
//                 thread: no thread can be started
//                 shrink: the file loses its second half before it is read
//   FAULT_EXCEPT  a file in that folder whose calls go right, for shrink; also under a longer name
//   FAULT_CALL    the number of the one call that goes wrong, counted from 1; 0: all of them
//   FAULT_MARK    a file that is made when a call has gone wrong
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

std::atomic<long> calls{0};
std::atomic<unsigned> interrupted{0};

const char* setting(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

bool is_kind(const char* kind) { return std::strcmp(setting("FAULT_KIND"), kind) == 0; }

/// Whether calls go wrong that cannot do less than asked.
bool may_fail() { return is_kind("fail") || is_kind("interrupt"); }

bool is_ours(const std::string& path) {
  const char* folder = setting("FAULT_FOLDER");
  return *folder != '\0' && path.compare(0, std::strlen(folder), folder) == 0;
}

std::string path_of(int descriptor) {
  char path[4096];
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t length = ::readlink(link.c_str(), path, sizeof path);
  return length < 0 ? std::string() : std::string(path, static_cast<std::size_t>(length));
}

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

void mark() {
  static auto* const open_file = next<int(const char*, int, ...)>("open");
  const int made = open_file(setting("FAULT_MARK"), O_CREAT | O_WRONLY | O_CLOEXEC, 0666);
  if (made >= 0) ::close(made);
}

/// Whether this call, on a file of the folder, is to go wrong.
bool goes_wrong() {
  const long wanted = std::atol(setting("FAULT_CALL"));
  if (++calls != wanted && wanted != 0) return false;
  if (is_kind("interrupt") && ++interrupted % 2 == 0) return false;
  mark();
  return true;
}

/// Calls what cannot do less than asked, or goes wrong with an error; only if it `may`.
template <typename Call>
int all_or_nothing(bool may, const std::string& path, int error, Call call) {
  if (!may || !is_ours(path) || !goes_wrong()) return call();
  errno = is_kind("interrupt") ? EINTR : error;
  return -1;
}

/// Reads or writes `count` bytes by `call`, which is given how many; goes wrong in the way that is
/// set.
template <typename Call>
ssize_t transfer(int descriptor, std::size_t count, int error, Call call) {
  const std::string path = path_of(descriptor);
  if (is_kind("thread") || !is_ours(path)) return call(count);
  const bool reading = error == EIO;
  if (is_kind("shrink")) {
    struct stat status {};
    const std::string except = setting("FAULT_EXCEPT");
    const bool excepted = !except.empty() && path.compare(0, except.size(), except) == 0;
    if (reading && !excepted && goes_wrong() && ::fstat(descriptor, &status) == 0) {
      if (::truncate(path.c_str(), status.st_size / 2) != 0) return call(count);
    }
    return call(count);
  }
  if (!goes_wrong()) return call(count);
  if (is_kind("short")) return call(count > 1 ? count / 2 : count);
  errno = is_kind("interrupt") ? EINTR : error;
  return -1;
}

}  // namespace

extern "C" {

ssize_t read(int descriptor, void* to, std::size_t count) {
  static auto* const original = next<ssize_t(int, void*, std::size_t)>("read");
  return transfer(descriptor, count, EIO,
                  [=](std::size_t some) { return original(descriptor, to, some); });
}

ssize_t pread64(int descriptor, void* to, std::size_t count, off64_t at) {
  static auto* const original = next<ssize_t(int, void*, std::size_t, off64_t)>("pread64");
  return transfer(descriptor, count, EIO,
                  [=](std::size_t some) { return original(descriptor, to, some, at); });
}

ssize_t pread(int descriptor, void* to, std::size_t count, off_t at) {
  return pread64(descriptor, to, count, at);
}

ssize_t write(int descriptor, const void* from, std::size_t count) {
  static auto* const original = next<ssize_t(int, const void*, std::size_t)>("write");
  return transfer(descriptor, count, ENOSPC,
                  [=](std::size_t some) { return original(descriptor, from, some); });
}

ssize_t pwrite64(int descriptor, const void* from, std::size_t count, off64_t at) {
  static auto* const original = next<ssize_t(int, const void*, std::size_t, off64_t)>("pwrite64");
  return transfer(descriptor, count, ENOSPC,
                  [=](std::size_t some) { return original(descriptor, from, some, at); });
}

ssize_t pwrite(int descriptor, const void* from, std::size_t count, off_t at) {
  return pwrite64(descriptor, from, count, at);
}

int fsync(int descriptor) {
  static auto* const original = next<int(int)>("fsync");
  return all_or_nothing(may_fail(), path_of(descriptor) + "/", EIO,
                        [=] { return original(descriptor); });
}

int ftruncate64(int descriptor, off64_t size) {
  static auto* const original = next<int(int, off64_t)>("ftruncate64");
  return all_or_nothing(is_kind("fail"), path_of(descriptor), ENOSPC,
                        [=] { return original(descriptor, size); });
}

int ftruncate(int descriptor, off_t size) { return ftruncate64(descriptor, size); }

int posix_fallocate64(int descriptor, off64_t at, off64_t size) {
  static auto* const original = next<int(int, off64_t, off64_t)>("posix_fallocate64");
  const int result = all_or_nothing(may_fail(), path_of(descriptor), ENOSPC,
                                    [=] { return original(descriptor, at, size); });
  return result < 0 ? errno : result;
}

int posix_fallocate(int descriptor, off_t at, off_t size) {
  return posix_fallocate64(descriptor, at, size);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                   void* argument) {
  static auto* const original =
      next<int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*)>("pthread_create");
  if (!is_kind("thread") || !goes_wrong()) return original(thread, attributes, start, argument);
  return EAGAIN;
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  static auto* const original =
      next<int(int, const char*, int, const char*, unsigned)>("renameat2");
  return all_or_nothing(is_kind("fail"), from, EIO,
                        [=] { return original(from_folder, from, to_folder, to, flags); });
}

}  // extern "C"
