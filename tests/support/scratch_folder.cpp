#include "support/scratch_folder.hpp"

#include <stdlib.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

namespace clearway::test {

ScratchFolder::ScratchFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "clearway-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path ScratchFolder::write(const std::string& name, std::string_view bytes) const {
  const auto path = path_ / name;
  std::filesystem::remove(path);  // rewriting a file in place makes some file systems sync it
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
  return path;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

void put_bytes(const std::filesystem::path& path, const std::string& bytes) {
  const bool in_place = std::filesystem::is_regular_file(path);
  const auto mode = std::ios::binary | std::ios::out | (in_place ? std::ios::in : std::ios::out);
  std::ofstream out(path, mode);
  out << bytes;
  if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
  if (in_place && std::filesystem::file_size(path) > bytes.size()) {
    std::filesystem::resize_file(path, bytes.size());
  }
}

}  // namespace clearway::test
