#pragma once

#include <stdlib.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/error.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway::test {

/// A temporary folder that is removed when its owner ends.
class ReaderScratch {
 public:
  ReaderScratch() {
    std::string pattern = (std::filesystem::temp_directory_path() / "clearway-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
  }
  ReaderScratch(const ReaderScratch&) = delete;
  ReaderScratch& operator=(const ReaderScratch&) = delete;
  ~ReaderScratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  const std::filesystem::path& folder() const { return folder_; }

  /// Writes a file of that name and returns its path.
  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    const auto path = folder_ / name;
    std::filesystem::remove(path);  // rewriting a file in place makes some file systems sync it
    std::ofstream out(path, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
    return path;
  }

 private:
  std::filesystem::path folder_;
};

struct ReadCloud {
  CloudInfo info;  ///< what the reader tells after the last point
  std::vector<std::array<std::int32_t, 3>> quanta;
  std::vector<Vec3> positions;
  std::vector<std::uint8_t> classes, flags;

  std::size_t size() const { return quanta.size() + positions.size(); }
};

inline ReadCloud read_all(PointReader& reader) {
  ReadCloud cloud;
  PointBatch batch;
  while (reader.read(batch)) {
    cloud.quanta.insert(cloud.quanta.end(), batch.quanta.begin(), batch.quanta.end());
    cloud.positions.insert(cloud.positions.end(), batch.positions.begin(), batch.positions.end());
    cloud.classes.insert(cloud.classes.end(), batch.classes.begin(), batch.classes.end());
    cloud.flags.insert(cloud.flags.end(), batch.flags.begin(), batch.flags.end());
  }
  if (batch.size() != 0) throw std::logic_error("a batch at the end");
  cloud.info = reader.info();
  return cloud;
}

inline ReadCloud read_all(const std::filesystem::path& path) {
  return read_all(*open_point_file(path));
}

/// The message with which reading the file is refused; empty where it is read.
inline std::string refusal_of(const std::filesystem::path& path) {
  try {
    read_all(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

/// The message with which reading the file as a LAS stream is refused; empty where it is read.
inline std::string stream_refusal_of(const std::filesystem::path& path) {
  try {
    read_all(
        *open_las_stream(File::open_for_reading(path), std::filesystem::temp_directory_path()));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace clearway::test
