#include "io/scans/point_reader.hpp"

#include <algorithm>
#include <utility>

#include "io/files/input_error.hpp"
#include "io/scans/e57/e57_reader.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/las/las_reader.hpp"
#include "io/scans/pcd/pcd_reader.hpp"
#include "io/scans/ply/ply_reader.hpp"
#include "io/scans/point_formats.hpp"
#include "io/scans/ptx/ptx_reader.hpp"
#include "io/scans/text_copy.hpp"
#include "io/scans/threedtk/threedtk_reader.hpp"

namespace clearway {
namespace {

PointFormat format_of(const File& file, const std::filesystem::path& path) {
  std::array<std::byte, 16> bytes{};
  const std::span<std::byte> first(bytes.data(),
                                   std::min<std::uint64_t>(bytes.size(), file.size_bytes()));
  file.read_at(0, first);
  auto format = format_of_content(first);
  if (!format) format = format_of_name(path);
  if (!format) {
    refuse_foreign(file.name(), {reinterpret_cast<const char*>(first.data()), first.size()});
    refuse(file.name(), "unknown format of points; expected the ending " + sure_endings() +
                            ", or txt or csv for text");
  }
  return *format;
}

std::unique_ptr<PointReader> open_as(PointFormat format, File file,
                                     const std::filesystem::path& path,
                                     const PointReadOptions& options) {
  if (format == PointFormat::kE57) return read_e57(std::move(file));
  InputBuffer input(std::move(file), InputBuffer::Access::kSeek);
  switch (format) {
    case PointFormat::kLas:
      return read_las(std::move(input), options.with_times);
    case PointFormat::kPly:
      return read_ply(std::move(input));
    case PointFormat::kPcd:
      return read_pcd(std::move(input));
    case PointFormat::k3dtk:
      return read_threedtk(std::move(input), path);
    default:
      return read_scan_text(std::move(input), format == PointFormat::kPtx, options);
  }
}

}  // namespace

std::unique_ptr<PointReader> open_point_file(const std::filesystem::path& path,
                                             const PointReadOptions& options) {
  File file = File::open_for_reading(path);
  if (!file.is_regular()) {
    return open_las_stream(std::move(file), std::filesystem::temp_directory_path(), options);
  }
  const PointFormat format = format_of(file, path);
  refuse_unless_read(format, file.name());
  try {
    return open_as(format, std::move(file), path, options);
  } catch (const InputError&) {
    if (format == PointFormat::kLas || format == PointFormat::kE57) {
      refuse_if_copied_as_text(File::open_for_reading(path));
    }
    throw;
  }
}

}  // namespace clearway
