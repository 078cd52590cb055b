#include "io/files/pending_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/file.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_with_errno(const fs::path& path, const char* what) {
  throw system_failure(path.string() + ": cannot " + what, errno);
}

void check_output_name(const fs::path& path, bool overwrite) {
  if (path.empty()) throw UsageError("the output needs the name of a file");
  std::error_code unknown;
  if (fs::is_directory(path, unknown)) {
    throw UsageError(path.string() + ": is a directory, expected a file name for the output");
  }
  if (fs::exists(path, unknown) && !fs::is_regular_file(path, unknown)) {
    throw UsageError(path.string() + ": is a device or pipe, expected a file name for the output");
  }
  if (!overwrite && fs::exists(fs::symlink_status(path, unknown))) {
    throw UsageError(path.string() + ": exists already", Remedy::kOverwrite);
  }
  if (!fs::is_directory(folder_of(path), unknown)) {
    throw ResourceError(folder_of(path).string() + ": no such folder for the output");
  }
}

[[noreturn]] void refuse_partial(const fs::path& path, const char* what) {
  throw UsageError(path.string() + ": is where this output's temporary file has to be, and " +
                   what + "; move it away, or choose another output");
}

/// Throws where the partial file is a link, a pipe or a device, through which the output would go
/// elsewhere.
void check_partial(const fs::path& path) {
  std::error_code unknown;
  const fs::file_status found = fs::symlink_status(path, unknown);
  if (fs::exists(found) && !fs::is_regular_file(found)) refuse_partial(path, "is no file");
}

File create_locked(const fs::path& path) {
  for (;;) {
    check_partial(path);
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor < 0 && (errno == EINTR || errno == ELOOP)) continue;
    if (descriptor < 0) fail_with_errno(path, "create");
    File file = File::adopt(descriptor, path.string());
    if (!lock_whole(file)) {
      throw ResourceError(path.string() +
                          ": another process is writing it; wait for it, or choose another output");
    }
    // Its last owner may have renamed or removed it between opening and locking.
    if (!file.is_at(path)) continue;
    if (file.names() > 1) refuse_partial(path, "has another name too");
    return file;
  }
}

fs::path partial_of(const fs::path& path) { return path.string() + ".partial"; }

}  // namespace

PendingFile::PendingFile(fs::path path, bool overwrite)
    : final_((check_output_name(path, overwrite), std::move(path))),
      partial_(partial_of(final_)),
      overwrite_(overwrite),
      lock_(create_locked(partial_)) {}

PendingFile::~PendingFile() {
  if (!published_ && !kept_) ::unlink(partial_.c_str());
}

void PendingFile::refuse_existing() {
  overwrite_ = false;
  check_output_name(final_, overwrite_);
}

void PendingFile::sync() const { File::open_for_reading(partial_).sync(); }

void PendingFile::publish() {
  sync();
  const unsigned flags = overwrite_ ? 0 : RENAME_NOREPLACE;
  int failed = ::renameat2(AT_FDCWD, partial_.c_str(), AT_FDCWD, final_.c_str(), flags);
  if (failed != 0 && errno == EINVAL) {  // a file system without RENAME_NOREPLACE
    failed = ::rename(partial_.c_str(), final_.c_str());
  }
  if (failed != 0) fail_with_errno(final_, "rename the finished file to it");
  published_ = true;
  const int folder = ::open(folder_of(final_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) fail_with_errno(folder_of(final_), "open");
  File::adopt(folder, folder_of(final_).string()).sync();
}

void refuse_overwriting(const fs::path& output, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    for (const fs::path& written : {output, partial_of(output)}) {
      std::error_code unknown;
      if (!fs::equivalent(written, input, unknown) || unknown) continue;
      throw UsageError(written.string() +
                       ": is an input too; expected another name for the output");
    }
  }
}

}  // namespace clearway
