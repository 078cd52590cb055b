#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <vector>

#include "core/error.hpp"
#include "io/hdf5.hpp"
#include "io/result.hpp"
#include "io/result_names.hpp"

namespace clearway {
namespace {

namespace names = result_names;

/// A multiple of every dataset's chunk rows. The order of the writes, and with it every address in
/// the file, follows from it and the number of rows, not from how they were appended.
constexpr std::size_t kBufferRows = 1 << 16;

static_assert(sizeof(Vec3) == 3 * sizeof(double));

std::span<const double> as_numbers(std::span<const Vec3> points) {
  return {points.empty() ? nullptr : &points.front().x, 3 * points.size()};
}

template <typename Number>
void write_number(const hdf5::Id& file, const std::string& name, Number value) {
  hdf5::write_attribute(file, name, std::span<const Number>(&value, 1));
}

void write_header(const hdf5::Id& file, const ResultHeader& header) {
  hdf5::write_attribute(file, "format", std::string(names::kFormat));
  write_number(file, "version", names::kVersion);
  write_number(file, "environment_points", header.environment_points);
  write_number(file, "environment_hash", header.environment_hash);
  write_number(file, "model_points", header.model_points);
  write_number(file, "model_hash", header.model_hash);
  write_number(file, "poses", header.poses);
  write_number(file, "trajectory_hash", header.trajectory_hash);
  write_number(file, "radius", header.radius);
  write_number(file, "first_pose", static_cast<std::uint8_t>(header.first_pose));
  write_number(file, "between_poses", static_cast<std::uint8_t>(header.between_poses));
  hdf5::write_attribute(file, "scale", std::span<const double>(header.quantisation.scale));
  hdf5::write_attribute(file, "offset", std::span<const double>(header.quantisation.offset));
  hdf5::write_attribute(file, "crs_wkt", header.crs_wkt);
}

/// Runs `call`, putting the file's name before the message of a failure.
template <typename Call>
auto naming(const std::string& file, Call call) {
  try {
    return call();
  } catch (const ResourceError& error) {
    throw ResourceError(file + ": " + error.what());
  }
}

template <typename Value>
void add(std::vector<Value>& buffer, std::span<const Value> values) {
  buffer.insert(buffer.end(), values.begin(), values.end());
}

/// The rows not yet written, at most kBufferRows.
struct Buffer {
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;
  std::vector<std::uint32_t> first_pose;
};

struct Datasets {
  Datasets(const hdf5::Id& group, bool with_first_pose, std::uint64_t rows)
      : source(group, names::kSource, rows, 0), xyz(group, names::kXyz, rows, 3) {
    if (with_first_pose) first_pose.emplace(group, names::kFirstPose, rows, 0);
  }

  void write(std::uint64_t first, const Buffer& buffer) {
    source.write(first, buffer.source);
    xyz.write(first, as_numbers(buffer.xyz));
    if (first_pose) first_pose->write(first, buffer.first_pose);
  }

  hdf5::Rows<std::uint64_t> source;
  hdf5::Rows<double> xyz;
  std::optional<hdf5::Rows<std::uint32_t>> first_pose;
};

}  // namespace

struct ResultWriter::State {
  State(const std::filesystem::path& path, const ResultHeader& header, std::uint64_t collisions)
      : name(path.string()),
        has_first_pose(header.first_pose),
        promised(collisions),
        file(hdf5::create_file(path)),
        group(hdf5::create_group(file, names::kGroup)),
        datasets(std::in_place, group, header.first_pose, collisions) {
    write_header(file, header);
  }

  std::uint64_t rows() const { return written + buffer.source.size(); }

  void flush() {
    datasets->write(written, buffer);
    written = rows();
    buffer.source.clear();
    buffer.xyz.clear();
    buffer.first_pose.clear();
  }

  std::string name;
  bool has_first_pose;
  std::uint64_t promised;
  hdf5::Id file, group;
  std::optional<Datasets> datasets;
  Buffer buffer;
  std::uint64_t written = 0;
  std::optional<std::uint64_t> last_source;
};

ResultWriter::ResultWriter(const std::filesystem::path& path, const ResultHeader& header,
                           std::uint64_t collisions)
    : state_(naming(path.string(),
                    [&] { return std::make_unique<State>(path, header, collisions); })) {}

ResultWriter::~ResultWriter() = default;

void ResultWriter::append(std::span<const std::uint64_t> source, std::span<const Vec3> xyz,
                          std::span<const std::uint32_t> first_pose) {
  State& s = *state_;
  if (xyz.size() != source.size() || first_pose.size() != (s.has_first_pose ? source.size() : 0)) {
    throw std::logic_error("ResultWriter: rows of unequal lengths");
  }
  if (source.size() > s.promised - s.rows()) {
    throw std::logic_error("ResultWriter: more rows than promised");
  }
  for (const std::uint64_t index : source) {
    if (s.last_source && index <= *s.last_source) {
      throw std::logic_error("ResultWriter: rows not ascending by source");
    }
    s.last_source = index;
  }
  for (std::size_t from = 0; from < source.size();) {
    const std::size_t count = std::min(source.size() - from, kBufferRows - s.buffer.source.size());
    add(s.buffer.source, source.subspan(from, count));
    add(s.buffer.xyz, xyz.subspan(from, count));
    if (s.has_first_pose) add(s.buffer.first_pose, first_pose.subspan(from, count));
    from += count;
    if (s.buffer.source.size() == kBufferRows) naming(s.name, [&] { s.flush(); });
  }
}

void ResultWriter::finish() {
  State& s = *state_;
  if (s.rows() != s.promised) {
    throw std::logic_error("ResultWriter: " + std::to_string(s.rows()) + " rows written, " +
                           std::to_string(s.promised) + " promised");
  }
  naming(s.name, [&] {
    s.flush();
    write_number(s.file, "complete", std::uint8_t{1});
    hdf5::check(H5Fflush(s.file.get(), H5F_SCOPE_LOCAL), "write the result");
    s.datasets.reset();  // after the flush nothing is left that their closing could fail to write
    s.group.close("close the result's group");
    s.file.close("close the result");
  });
}

}  // namespace clearway
