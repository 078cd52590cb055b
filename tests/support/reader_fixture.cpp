#include "support/reader_fixture.hpp"

#include <stdexcept>

namespace clearway::test {

ReadCloud read_all(PointReader& reader) {
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

ReadCloud read_all(const std::filesystem::path& path) { return read_all(*open_point_file(path)); }

std::string refusal_of(const std::filesystem::path& path) {
  try {
    read_all(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

std::string stream_refusal_of(const std::filesystem::path& path) {
  try {
    read_all(
        *open_las_stream(File::open_for_reading(path), std::filesystem::temp_directory_path()));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace clearway::test
