#include "io/convert/source_description.hpp"

#include <charconv>
#include <cstddef>
#include <span>

#include "io/system/file.hpp"
#include "io/system/xxh64.hpp"

namespace clearway {

SourceFile describe(const std::filesystem::path& path, const std::stop_token& stop,
                    const Progress& progress) {
  if (path == "-") return {"-", 0, 0};
  const File file = File::open_for_reading(path);
  std::vector<std::byte> buffer(std::size_t{1} << 20);
  Xxh64Stream hash;
  std::uint64_t bytes = 0;
  while (const std::size_t got = file.read_some(buffer)) {
    if (stop.stop_requested()) break;
    throw_if_stopped(progress);
    hash.update(std::span(buffer).first(got));
    bytes += got;
  }
  return {path.filename().string(), bytes, hash.digest()};
}

std::string layout_name(const std::optional<double>& regular_size) {
  if (!regular_size) return "adaptive";
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, *regular_size).ptr;
  return "regular:" + std::string(text, end);
}

}  // namespace clearway
