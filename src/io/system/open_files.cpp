#include "io/system/open_files.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "clearway/error.hpp"

namespace clearway {
namespace {

/// Files for outputs, libraries and brief use.
constexpr std::uint64_t kSpare = 16;

std::uint64_t open_files() {
  std::error_code unknown;
  const std::filesystem::directory_iterator files("/proc/self/fd", unknown);
  if (unknown) return kSpare;
  return static_cast<std::uint64_t>(std::distance(begin(files), end(files)));
}

}  // namespace

std::uint64_t needed_open_files(std::uint64_t more) { return open_files() + more + kSpare; }

void require_open_files(std::uint64_t more, const std::string& purpose) {
  rlimit limit{};
  const std::uint64_t needed = needed_open_files(more);
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= needed) return;
  throw ResourceError(purpose + " needs " + std::to_string(needed) +
                      " open files, and this process may open " + std::to_string(limit.rlim_cur) +
                      "; ulimit -n " + std::to_string(needed) + " allows them");
}

void raise_open_files_limit(std::uint64_t more) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  const rlim_t wanted = std::min<rlim_t>(needed_open_files(more) + kSpare, limit.rlim_max);
  if (wanted <= limit.rlim_cur) return;
  limit.rlim_cur = wanted;
  // A failure is ignored, as require_open_files() reports it later.
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace clearway
