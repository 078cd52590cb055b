#include "io/files/input_error.hpp"

#include <unistd.h>

#include <span>
#include <system_error>

#include "clearway/error.hpp"
#include "io/files/file.hpp"

namespace clearway {

void refuse(const std::string& name, const std::string& what, Remedy remedy, double amount) {
  throw InputError(name + ": " + what, remedy, amount);
}

void refuse_byte(const std::string& name, std::uint64_t byte, const std::string& what) {
  refuse(name, "byte " + std::to_string(byte) + ": " + what);
}

void refuse_line(const std::string& name, std::uint64_t line, const std::string& what,
                 Remedy remedy) {
  refuse(name, "line " + std::to_string(line) + ": " + what, remedy);
}

void refuse_foreign(const std::string& name, std::string_view first) {
  using namespace std::string_view_literals;
  constexpr const char* kFromGis =
      ", which is not read; expected text. A GIS exports its points as CSV or LAS, and its lines "
      "as "
      "CSV or GeoJSON";
  const struct {
    std::string_view start;
    const char* kind;
    const char* advice;
  } kinds[] = {
      {"PK\x03\x04"sv, "a ZIP archive, as spreadsheets are",
       "; expected text. Export the table as CSV"},
      {"\xD0\xCF\x11\xE0"sv, "a document of an office program",
       "; expected text. Export the table as CSV"},
      {"\0\0\x27\x0A"sv, "a shapefile", kFromGis},
      {"SQLite format 3\0"sv, "a GeoPackage or another SQLite database", kFromGis},
      {"\x1F\x8B"sv, "compressed with gzip", "; expected text. Unpack it first"},
      {"%PDF"sv, "a PDF", "; expected text. Export the table as CSV"},
      {"\x89HDF"sv, "an HDF5 file, as stores and results are", "; expected text"},
  };
  for (const auto& [start, kind, advice] : kinds) {
    if (first.starts_with(start)) refuse(name, std::string("is ") + kind + advice);
  }
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string result = "\"";
  for (const char c : text.substr(0, kLongest)) {
    result += c == '\t' ? ' ' : c >= ' ' && c <= '~' ? c : '?';
  }
  return result + (text.size() > kLongest ? "...\"" : "\"");
}

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
  if (failed) throw system_failure(path.string() + ": cannot write", failed.value());
}

}  // namespace clearway
