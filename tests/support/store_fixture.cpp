#include "support/store_fixture.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "io/scans/las/las_writer.hpp"
#include "io/scans/ply/ply_writer.hpp"
#include "io/store/verify_store.hpp"
#include "support/compare.hpp"

namespace clearway::test {

void write_las(const std::filesystem::path& path, std::span<const Quantum> points,
               const Quantisation& quantisation) {
  const File file = File::create(path);
  LasWriter writer(file, LasFormat::of_points(quantisation, points.size()));
  writer.write(points);
  writer.finish();
}

void write_ply(const std::filesystem::path& path, std::span<const Vec3> points) {
  const File file = File::create(path);
  PlyWriter writer(file, {.points = points.size()});
  writer.write(points);
  writer.finish();
}

ConversionOptions conversion_of(std::vector<std::filesystem::path> inputs,
                                const std::filesystem::path& output, std::uint32_t cell_points) {
  ConversionOptions options;
  options.inputs = std::move(inputs);
  options.output = output;
  options.cell_points = cell_points;
  options.threads = 2;
  options.overwrite = true;
  return options;
}

ConversionReport convert_quietly(const ConversionOptions& options) {
  NoProgress progress;
  return convert_scans(options, progress);
}

bool is_converted_by(const ConversionOptions& options) {
  NoProgress progress;
  return is_converted(options, progress);
}

void Conversion::add(const std::string& name, const std::string& bytes) {
  put_bytes(folder / name, bytes);
  add_input(folder / name);
}

void Conversion::add_las(const std::string& name, std::span<const Quantum> points,
                         const Quantisation& quantisation) {
  write_las(folder / name, points, quantisation);
  add_input(folder / name);
}

void Conversion::add_ply(const std::string& name, std::span<const Vec3> points) {
  write_ply(folder / name, points);
  add_input(folder / name);
}

void Conversion::add_input(const std::filesystem::path& path) {
  if (std::ranges::find(options.inputs, path) == options.inputs.end()) {
    options.inputs.push_back(path);
  }
}

std::string Conversion::converted_bytes() const {
  convert();
  return bytes_of(options.output);
}

StoreReader Conversion::store() const {
  convert();
  check_equal(faults_of(StoreReader(options.output)), {});
  return StoreReader(options.output);
}

double number_of(const Message& message, std::string_view name) {
  for (const auto& [key, value] : message.numbers) {
    if (key == name) return value;
  }
  fail_check("no number " + std::string(name) + ": " + message.text);
  return 0;
}

std::vector<std::uint8_t> classes_by_source(const StoreReader& store) {
  std::vector<std::uint8_t> classes(store.metadata().input_points);
  for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
    const auto packed = store.classes(cell);
    const auto sources = store.sources(cell);
    for (std::uint32_t i = 0; i < store.cells()[cell].count; ++i) classes[sources[i]] = packed[i];
  }
  return classes;
}

std::vector<std::optional<OriginQuanta>> origins_by_source(const StoreReader& store) {
  std::vector<std::optional<OriginQuanta>> origins(store.metadata().input_points);
  for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
    const auto numbers = store.origins(cell);
    const auto sources = store.sources(cell);
    for (std::uint32_t i = 0; i < store.cells()[cell].count; ++i) {
      if (numbers[i] > 0) origins[sources[i]] = store.metadata().origins->quanta[numbers[i] - 1];
    }
  }
  return origins;
}

std::vector<StoredPoint> points_of_cells(const StoreReader& store, std::uint32_t first,
                                         std::uint32_t count) {
  std::vector<StoredPoint> points;
  std::vector<std::int32_t> values(store.cell_points());
  std::vector<std::uint64_t> sources(store.cell_points());
  for (std::uint32_t cell = first; cell < first + count; ++cell) {
    const std::size_t at = points.size();
    const std::uint32_t used = store.cells()[cell].count;
    points.resize(at + used);
    const auto coordinates = store.coordinates(cell);
    for (std::size_t k = 0; k < 3; ++k) {
      coordinates[k].decode(0, values);
      for (std::uint32_t i = 0; i < used; ++i) points[at + i].q[k] = values[i];
    }
    store.sources(cell).decode(0, sources);
    for (std::uint32_t i = 0; i < used; ++i) points[at + i].source = sources[i];
  }
  return points;
}

std::vector<StoredPoint> stored_points(const StoreReader& store) {
  return points_of_cells(store, 0, static_cast<std::uint32_t>(store.cells().size()));
}

std::vector<Quantum> points_by_source(const StoreReader& store) {
  std::vector<Quantum> points(store.point_count());
  std::vector<bool> seen(points.size());
  for (const StoredPoint& point : stored_points(store)) {
    if (point.source >= points.size() || seen[point.source]) {
      throw std::runtime_error("sources are no permutation");
    }
    seen[point.source] = true;
    points[point.source] = point.q;
  }
  return points;
}

std::vector<std::string> faults_of(const StoreReader& store) {
  NoProgress progress;
  return verify_store(store, progress, 20);
}

}  // namespace clearway::test
