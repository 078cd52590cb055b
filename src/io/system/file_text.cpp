#include "io/system/file_text.hpp"

#include <unistd.h>

#include <span>
#include <system_error>

#include "clearway/error.hpp"
#include "io/system/file.hpp"

namespace clearway {

namespace fs = std::filesystem;

std::string text_of_file(const fs::path& path) {
  const File file = File::open_regular(path);
  std::string text;
  std::string piece(1 << 16, '\0');
  while (const std::size_t bytes = file.read_some(std::as_writable_bytes(std::span(piece)))) {
    text.append(piece, 0, bytes);
  }
  return text;
}

void replace_file(const fs::path& path, std::string_view text) {
  const fs::path written = path.string() + ".new." + std::to_string(::getpid());
  try {
    File::create(written).write(std::as_bytes(std::span(text)));
  } catch (...) {
    std::error_code ignored;
    fs::remove(written, ignored);
    throw;
  }
  std::error_code failed;
  fs::rename(written, path, failed);
  if (failed) throw ResourceError(path.string() + ": cannot write: " + failed.message());
}

}  // namespace clearway
