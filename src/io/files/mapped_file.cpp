#include "io/files/mapped_file.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <mutex>

#include "clearway/error.hpp"

namespace clearway {

/// A map as the signal handler reads it: in fixed memory, written before the map is handed out.
struct MapRecord {
  std::atomic<std::uintptr_t> first{0};
  std::atomic<std::uintptr_t> last{0};
  std::atomic<bool> survives{false}, failed{false};
  std::array<char, 512> name{};
};

namespace {

std::array<MapRecord, 64> map_records;
/// The exit code of a program that ends at a fault; negative where none does.
std::atomic<int> fault_exit_code{-1};
/// What was done about SIGBUS before. Written before the handler is installed.
struct sigaction action_before {};

/// The bytes of the pages of a map, the last of which may reach past the end of the file.
std::uintptr_t whole_pages(std::size_t bytes) {
  const auto page_bytes = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  return (bytes + page_bytes - 1) / page_bytes * page_bytes;
}

/// Returns null where there are too many maps, which are then not known to the handler.
MapRecord* remember(std::span<const std::byte> bytes, const std::string& name) {
  for (MapRecord& record : map_records) {
    std::uintptr_t free_slot = 0;
    const auto first = reinterpret_cast<std::uintptr_t>(bytes.data());
    if (!record.first.compare_exchange_strong(free_slot, first)) continue;
    const std::size_t length = std::min(name.size(), record.name.size() - 1);
    std::memcpy(record.name.data(), name.data(), length);
    record.name[length] = '\0';
    record.survives = record.failed = false;
    record.last = first + whole_pages(bytes.size());
    return &record;
  }
  return nullptr;
}

void forget(MapRecord* record) {
  if (record == nullptr) return;
  record->last = 0;
  record->first = 0;
}

/// The map that an address lies in, or null.
MapRecord* record_of(std::uintptr_t address) {
  for (MapRecord& record : map_records) {
    const std::uintptr_t first = record.first;
    if (first != 0 && address >= first && address < record.last) return &record;
  }
  return nullptr;
}

void put(const char* text) {
  if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) return;
}

/// Puts a page of zeros in the place of the page that cannot be read, so that the thread goes on.
bool replace_page(std::uintptr_t address) {
  const auto page_bytes = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  void* const page = reinterpret_cast<void*>(address - address % page_bytes);
  return ::mmap(page, page_bytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) !=
         MAP_FAILED;
}

/// Does what was done about the signal before; the default ends the process once the fault occurs
/// again.
void pass_on(int signal, siginfo_t* info, void* context) {
  if ((action_before.sa_flags & SA_SIGINFO) != 0) {
    action_before.sa_sigaction(signal, info, context);
  } else if (action_before.sa_handler != SIG_DFL && action_before.sa_handler != SIG_IGN) {
    action_before.sa_handler(signal);
  } else {
    ::signal(SIGBUS, SIG_DFL);
  }
}

void on_map_fault(int signal, siginfo_t* info, void* context) {
  const int error = errno;
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  MapRecord* const record = record_of(address);
  if (record != nullptr && record->survives) {
    record->failed = true;
    if (replace_page(address)) {
      errno = error;
      return;
    }
  }
  if (record != nullptr && fault_exit_code >= 0) {
    put("error: ");
    put(record->name.data());
    put(": the file shrank or could not be read while it was in use\n");
    ::_exit(fault_exit_code);
  }
  pass_on(signal, info, context);
}

void install_handler() {
  struct sigaction before {};
  if (::sigaction(SIGBUS, nullptr, &before) != 0) return;
  const bool is_ours = (before.sa_flags & SA_SIGINFO) != 0 && before.sa_sigaction == on_map_fault;
  if (is_ours) return;
  action_before = before;
  struct sigaction action {};
  action.sa_sigaction = on_map_fault;
  action.sa_flags = SA_SIGINFO;
  ::sigaction(SIGBUS, &action, nullptr);
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) : file_(File::open_regular(path)) {
  map(0, file_.size_bytes(), MAP_SHARED);
}

MappedFile::MappedFile(const File& file, std::uint64_t first, std::size_t count)
    : file_(File::adopt(::fcntl(file.descriptor(), F_DUPFD_CLOEXEC, 0), file.name())) {
  map(first, count, MAP_SHARED | MAP_POPULATE);
}

void MappedFile::map(std::uint64_t first, std::size_t count, int flags) {
  if (count == 0) return;
  const std::uint64_t before = first % static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  void* address = ::mmap(nullptr, before + count, PROT_READ, flags, file_.descriptor(),
                         static_cast<off_t>(first - before));
  if (address == MAP_FAILED) {
    throw system_failure(name() + ": cannot map", errno);
  }
  map_ = {static_cast<const std::byte*>(address), before + count};
  bytes_ = map_.subspan(before);
  record_ = remember(map_, name());
}

MappedFile::~MappedFile() {
  if (map_.empty()) return;
  forget(record_);
  ::munmap(const_cast<std::byte*>(map_.data()), map_.size());
}

void MappedFile::survive_faults() const {
  static std::mutex installing;
  if (record_ == nullptr) return;
  const std::lock_guard lock(installing);
  install_handler();
  record_->survives = true;
}

bool MappedFile::failed() const { return record_ != nullptr && record_->failed; }

void install_map_fault_handler(int exit_code) {
  fault_exit_code = exit_code;
  install_handler();
}

}  // namespace clearway
