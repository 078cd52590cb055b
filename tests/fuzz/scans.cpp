// Any bytes as a file of points or a mesh.
#include <algorithm>
#include <cmath>

#include "core/geometry/point_box.hpp"
#include "fuzz.hpp"
#include "io/models/mesh/mesh_reader.hpp"
#include "io/models/mesh_facts.hpp"
#include "io/models/sample_mesh.hpp"
#include "io/result/export/export_scan_records.hpp"
#include "io/scans/e57/e57_reader.hpp"
#include "io/scans/las/las_header.hpp"
#include "io/scans/las/las_reader.hpp"
#include "io/scans/pcd/pcd_reader.hpp"
#include "io/scans/ply/ply_reader.hpp"
#include "io/scans/ptx/ptx_reader.hpp"
#include "io/scans/text/text_table.hpp"
#include "io/scans/text/xyz_reader.hpp"
#include "io/scans/threedtk/threedtk_frame.hpp"
#include "io/scans/threedtk/threedtk_reader.hpp"
#include "support/bytes/e57_bytes.hpp"
#include "support/bytes/laz/laz_bytes.hpp"
#include "support/scratch_folder.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

InputBuffer buffer_of(const MemoryFile& file) { return {file.open(), InputBuffer::Access::kSeek}; }

/// Reads the points twice, as a conversion does, and checks that their number is the same. batches:
/// the most that are read.
std::uint64_t read_twice(PointReader& reader, bool with_times = false, int batches = 1 << 30) {
  std::uint64_t counts[2] = {0, 0};
  for (std::uint64_t& count : counts) {
    PointBatch batch;
    for (int i = 0; i < batches && reader.read(batch); ++i) {
      require(batch.size() > 0 && batch.size() <= PointReader::kBatchPoints);
      const bool times = with_times && reader.info().gps_times != GpsTimes::kNone;
      require(batch.times.size() == (times ? batch.size() : 0));
      count += batch.size();
    }
    if (reader.can_rewind()) reader.rewind();
  }
  require(!reader.can_rewind() || counts[0] == counts[1]);
  return counts[0];
}

/// Reads the points, and lines of some, which ascend, at most one for each point.
void read_and_tell(PointReader& reader) {
  read_twice(reader);
  const std::uint64_t points[] = {0, 1, 5};
  const auto lines = reader.lines_of(points);
  require(lines.size() <= 3);
  for (std::size_t i = 1; i < lines.size(); ++i) require(lines[i] > lines[i - 1]);
}

template <auto Read>
void read_lines(Bytes bytes) {
  const MemoryFile file(bytes);
  may_refuse([&] { read_and_tell(*Read(buffer_of(file))); });
}

/// LAS from a file and from a pipe.
void read_las_bytes(Bytes bytes) {
  constexpr std::size_t kFormatByte = 104;
  if (bytes.size() > kFormatByte && bytes[kFormatByte] >= 0x40) return;  // LAZ
  const MemoryFile file(bytes);
  may_refuse([&] { read_twice(*read_las(buffer_of(file))); });
  may_refuse([&] {
    read_twice(
        *open_las_stream(file.open(), std::filesystem::temp_directory_path(), {.with_times = true}),
        true);
  });
}

/// LAS, whose records are copied as export --scans does.
void copy_las_records(Bytes bytes) {
  const MemoryFile file(bytes);
  may_refuse([&] {
    LasRecordReader reader(file.path());
    const std::uint64_t points = reader.header().points;
    if (reader.header().compressed) return;
    require(reader.format().extra_bytes.size() % kLasExtraBytes == 0);
    if (points == 0) return;
    for (const std::uint64_t point : {std::uint64_t{0}, points / 2, points - 1, points / 3}) {
      const auto record = reader.record(point);
      require(record.size() == reader.header().record_bytes);
      unsigned sum = 0;
      for (const std::byte byte : record) sum += std::to_integer<unsigned>(byte);
      require(sum <= 255 * record.size());
    }
  });
}

/// The bytes before the points of a sound LAZ file. settings: format, flags, points (2 bytes),
/// points of a chunk.
std::string sound_laz_head(Bytes settings) {
  LazBytes laz;
  const unsigned format = settings[0] % 7, flags = settings[1];
  laz.las.format = format < 4 ? format : format + 2;
  laz.las.minor = format < 4 ? 2 : 4;
  laz.las.extra_bytes = flags % 4;
  laz.variable = (flags & 4u) != 0;
  laz.chunked = (flags & 8u) == 0;
  laz.chunks = {settings[4] * 50u + 1};
  std::string head = laz.head(settings[2] + 256u * settings[3]);
  // Sets older versions of the items.
  if ((flags & 16u) != 0 && format < 4) {
    for (std::size_t at = head.size() - 2; at > laz.las.points_offset() + 54 + 34; at -= 6) {
      head[at] = 1;
    }
  }
  return head;
}

/// LAZ as a file; or, behind a sound header, as its chunk table and chunks. Not all points are
/// read, because a byte may hold a thousand of them.
void read_laz_bytes(Bytes bytes) {
  constexpr std::size_t kSettings = 5;
  std::string laz = text_of(bytes);
  if (!laz.starts_with("LASF")) {
    if (bytes.size() < kSettings) return;
    laz = sound_laz_head(bytes.first(kSettings)) + laz.substr(kSettings);
  }
  const MemoryFile file(laz);
  for (const bool with_times : {false, true}) {
    may_refuse([&] {
      const auto reader = read_las(buffer_of(file), with_times);
      require(read_twice(*reader, with_times, 4) <= *reader->info().declared_points);
    });
  }
}

/// E57. The checksums of pages would refuse nearly all bytes, so the first byte says what is done
/// before: 0 is nothing; for 1 the checksums are corrected; otherwise the bytes are the content,
/// which is put into small pages with right checksums and file size, so that a few hundred bytes
/// reach across several.
void read_e57_bytes(Bytes bytes) {
  constexpr std::size_t kPage = 128;
  if (bytes.empty()) return;
  std::string e57 = text_of(bytes.subspan(1));
  if (bytes[0] % 4 == 1) E57Bytes::repair(e57);
  if (bytes[0] % 4 > 1) {
    if (e57.size() >= E57Bytes::kHeaderBytes) E57Bytes::put<std::uint64_t>(e57, 40, kPage);
    e57 = E57Bytes::paged(e57, kPage);
  }
  const MemoryFile file(e57);
  may_refuse([&] { read_twice(*read_e57(file.open())); });
}

/// PTX or PTS text, a scan of 3DTK, or a file with its pose: the first byte chooses.
void read_ptx_bytes(Bytes bytes) {
  static const ScratchFolder empty;  // a folder in which a scan is alone, so that it needs no pose
  if (bytes.empty()) return;
  const MemoryFile file(bytes.subspan(1));
  may_refuse([&] {
    InputBuffer input = buffer_of(file);
    switch (bytes[0] % 6) {
      case 0:
        return read_and_tell(*read_ptx(std::move(input)));
      case 1:
        return read_and_tell(*read_scan_text(std::move(input), true));
      case 2:
        return read_and_tell(*read_scan_text(std::move(input), false));
      case 3:
        return read_and_tell(*read_threedtk(std::move(input), empty.folder() / "scan000.3d"));
      default:
        TextTable table(std::move(input));
        bytes[0] % 6 == 4 ? read_threedtk_pose(table) : read_threedtk_frames(table);
    }
  });
}

/// XYZ or PTS text, with the columns that it names and with columns that the caller chose.
void read_xyz_bytes(Bytes bytes) {
  const MemoryFile file(bytes);
  const PointReadOptions ways[] = {
      {}, {{"2", "3", "4"}, true}, {{"x", "z", "y"}, true}, {{"e", "2", "h"}, false}};
  for (const PointReadOptions& options : ways) {
    may_refuse([&] { read_and_tell(*read_xyz(buffer_of(file), options)); });
  }
}

/// Samples at a spacing that needs few points, however large or small the mesh.
void sample(const TriangleMesh& mesh) {
  const Box box = box_of(mesh.vertices);
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max(size, box.hi[k] - box.lo[k]);
  if (mesh.triangles.empty() || mesh.triangles.size() > 200 || !(size > 1e-6 && size < 1e8)) return;
  const double spacing = size / 16;
  const std::vector<Vec3> points = sample_mesh(mesh, spacing, "mesh");
  const auto near = [&](const Vec3& p) {
    return std::ranges::any_of(points, [&](const Vec3& q) {
      return std::hypot(p.x - q.x, p.y - q.y, p.z - q.z) <= spacing;
    });
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    Vec3 middle{};
    for (int k = 0; k < 3; ++k) {
      middle[k] = (mesh.vertices[a][k] + mesh.vertices[b][k] + mesh.vertices[c][k]) / 3;
    }
    require(near(mesh.vertices[a]) && near(middle));
  }
}

/// A mesh, which is sampled; the first byte chooses the format.
void read_mesh_bytes(Bytes bytes) {
  constexpr MeshFormat kFormats[] = {MeshFormat::kStl, MeshFormat::kObj, MeshFormat::kOff,
                                     MeshFormat::kPly};
  if (bytes.empty()) return;
  const MemoryFile file(bytes.subspan(1));
  may_refuse([&] {
    const TriangleMesh mesh = read_mesh(buffer_of(file), kFormats[bytes[0] % 4]).mesh;
    for (const Vec3& v : mesh.vertices) {
      require(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
    }
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t corner : triangle) require(corner < mesh.vertices.size());
    }
    facts_of(mesh);
    if (!mesh.vertices.empty()) sample(mesh);
  });
}

const bool kAdded = add_targets({{"e57", read_e57_bytes},
                                 {"las", read_las_bytes},
                                 {"las_records", copy_las_records},
                                 {"laz", read_laz_bytes},
                                 {"mesh", read_mesh_bytes},
                                 {"pcd", read_lines<read_pcd>},
                                 {"ply", read_lines<read_ply>},
                                 {"ptx", read_ptx_bytes},
                                 {"xyz", read_xyz_bytes}});

}  // namespace
