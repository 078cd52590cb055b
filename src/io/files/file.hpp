#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "clearway/error.hpp"

namespace clearway {

/// Owner of an open file descriptor. Every failure throws ResourceError with the file's name and
/// the system's reason; interrupted and short calls are continued.
class File {
 public:
  static File open_for_reading(const std::filesystem::path& path);
  /// Opens a file for reading. One that is not a regular file, such as a pipe, is refused at once,
  /// without waiting for its bytes.
  static File open_regular(const std::filesystem::path& path);
  /// Opens an existing file and keeps its bytes.
  static File open_for_writing(const std::filesystem::path& path);
  /// Creates the file or empties an existing one.
  static File create(const std::filesystem::path& path);
  /// Creates a file without a name in `folder`, which disappears when closed or when the process
  /// dies.
  static File create_temporary(const std::filesystem::path& folder);
  /// Takes over an open descriptor, for example standard input; `name` is for messages.
  static File adopt(int descriptor, std::string name);

  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  ~File();

  int descriptor() const { return descriptor_; }
  const std::string& name() const { return name_; }
  std::uint64_t size_bytes() const;
  bool is_regular() const;

  /// The size and the time of the last change, by which one sees whether a file was written to.
  struct Stamp {
    std::uint64_t size_bytes = 0;
    std::int64_t seconds = 0, nanoseconds = 0;
    friend bool operator==(const Stamp&, const Stamp&) = default;
  };
  Stamp stamp() const;
  /// Whether the path names this very file. A symbolic link there does not, whatever it leads to.
  bool is_at(const std::filesystem::path& path) const;
  /// Whether the path leads to this very file, by way of symbolic links or not.
  bool is_reached_by(const std::filesystem::path& path) const;
  /// Number of names (hard links) of the file.
  std::uint64_t names() const;

  /// Reads exactly out.size() bytes at `offset`, which must lie before the end of the file. Throws
  /// ResourceError for a file that has shrunk.
  void read_at(std::uint64_t offset, std::span<std::byte> out) const;
  /// Reads up to out.size() bytes at the current position; 0 at the end.
  std::size_t read_some(std::span<std::byte> out) const;
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes) const;
  /// Writes at the current position.
  void write(std::span<const std::byte> bytes) const;
  void rewind() const;
  /// Reserves disk space. Throws where there is not enough.
  void reserve(std::uint64_t bytes) const;
  /// Reserves disk space beyond the end of the file, whose length stays. Does nothing where the
  /// file system cannot.
  void reserve_ahead(std::uint64_t bytes) const;
  /// Makes the file end after this many bytes.
  void truncate(std::uint64_t bytes) const;
  /// Asks the system to start writing a range to the disk, without waiting for it.
  void begin_sync(std::uint64_t offset, std::uint64_t bytes) const;
  void sync() const;

 private:
  File(int descriptor, std::string name) : descriptor_(descriptor), name_(std::move(name)) {}

  int descriptor_ = -1;
  std::string name_;
};

/// The error of a call that failed: "`what`: the system's reason", which kFreeDisk helps against
/// where the disk is full. error: the value of errno.
ResourceError system_failure(const std::string& what, int error);

/// The folder that contains a path; "." for a bare name.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// Number of bytes free for this user in the file system of `folder`.
std::uint64_t free_disk_bytes(const std::filesystem::path& folder);

/// Takes the lock of the whole file, which is held until the file is closed. Returns false where
/// another open of the file, in this process or another, has it. On a file system without locks it
/// returns true.
bool lock_whole(const File& file);

enum class LockState { kFree, kHeld, kUnknown };  ///< kUnknown: the file system has no locks

/// Whether another open of the file has its lock. Takes no lock itself.
LockState lock_state(const File& file);

/// Number of files that a process may need to have open if it opens `more` than it has.
std::uint64_t needed_open_files(std::uint64_t more);

/// Throws ResourceError, which names the number and `ulimit -n`, where the soft limit is below
/// needed_open_files(more). purpose: as in "to merge 7 parts".
void require_open_files(std::uint64_t more, const std::string& purpose);

/// Raises the process's soft limit somewhat above needed_open_files(more), as far as its hard limit
/// allows. Only for programs: a library leaves limits as they are.
void raise_open_files_limit(std::uint64_t more);

/// The ending of a name including its dot, with ASCII letters in lower case: ".las"; empty where
/// there is none.
inline std::string file_ending(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return ending;
}

}  // namespace clearway
