#include "support/reader_fixture.hpp"

#include <cstring>
#include <stdexcept>

#include "support/compare.hpp"

namespace clearway::test {
namespace {

template <typename Read>
std::string refusal(Read read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

Vec3 ReadCloud::at(std::size_t index) const {
  if (quanta.empty()) return positions[index];
  const auto& q = quanta[index];
  return position(*info.quantisation, q[0], q[1], q[2]);
}

ReadCloud read_all(PointReader& reader) {
  ReadCloud cloud;
  PointBatch batch;
  while (reader.read(batch)) {
    for (const std::uint32_t i : batch.absent) cloud.absent.push_back(cloud.size() + i);
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

ReadCloud read_stream(const std::filesystem::path& path) {
  return read_all(
      *open_las_stream(File::open_for_reading(path), std::filesystem::temp_directory_path()));
}

std::string refusal_of(const std::filesystem::path& path) {
  return refusal([&] { read_all(path); });
}

std::string stream_refusal_of(const std::filesystem::path& path) {
  return refusal([&] { read_stream(path); });
}

std::string refusal_of_file(const std::string& name, std::string_view bytes) {
  static const ScratchFolder scratch;
  const auto path = scratch.write(name, bytes);
  const std::string message = refusal_of(path);
  if (!message.empty()) check_says(message, path.string());
  return message;
}

std::string edited(std::string bytes, std::size_t at, unsigned size, std::uint64_t value) {
  std::memcpy(bytes.data() + at, &value, size);
  return bytes;
}

}  // namespace clearway::test
