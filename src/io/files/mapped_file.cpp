#include "io/files/mapped_file.hpp"

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "clearway/error.hpp"

namespace clearway {
namespace {

/// A map as the signal handler reads it: in fixed memory, written before the map is handed out.
struct MapRecord {
  std::atomic<std::uintptr_t> first{0};
  std::atomic<std::uintptr_t> last{0};
  std::array<char, 512> name{};
};

std::array<MapRecord, 16> map_records;
int fault_exit_code = 1;

void remember(std::span<const std::byte> bytes, const std::string& name) {
  for (MapRecord& record : map_records) {
    std::uintptr_t free_slot = 0;
    const auto first = reinterpret_cast<std::uintptr_t>(bytes.data());
    if (!record.first.compare_exchange_strong(free_slot, first)) continue;
    const std::size_t length = std::min(name.size(), record.name.size() - 1);
    std::memcpy(record.name.data(), name.data(), length);
    record.name[length] = '\0';
    record.last = first + bytes.size();
    return;
  }
}

void forget(std::span<const std::byte> bytes) {
  for (MapRecord& record : map_records) {
    if (record.first == reinterpret_cast<std::uintptr_t>(bytes.data())) {
      record.last = 0;
      record.first = 0;
      return;
    }
  }
}

void put(const char* text) {
  if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) return;
}

void on_map_fault(int, siginfo_t* info, void*) {
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  for (const MapRecord& record : map_records) {
    // The last page may reach past the end of the file.
    if (address < record.first || address >= record.last + 65536) continue;
    put("error: ");
    put(record.name.data());
    put(": the file shrank or could not be read while it was in use\n");
    ::_exit(fault_exit_code);
  }
  ::signal(SIGBUS, SIG_DFL);
  ::raise(SIGBUS);
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) : file_(File::open_regular(path)) {
  const std::uint64_t size = file_.size_bytes();
  if (size == 0) return;
  void* address = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, file_.descriptor(), 0);
  if (address == MAP_FAILED) {
    throw ResourceError(name() + ": cannot map: " + std::strerror(errno));
  }
  bytes_ = {static_cast<const std::byte*>(address), size};
  remember(bytes_, name());
}

MappedFile::~MappedFile() {
  if (bytes_.empty()) return;
  forget(bytes_);
  ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

void install_map_fault_handler(int exit_code) {
  fault_exit_code = exit_code;
  struct sigaction action {};
  action.sa_sigaction = on_map_fault;
  action.sa_flags = SA_SIGINFO;
  ::sigaction(SIGBUS, &action, nullptr);
}

}  // namespace clearway
