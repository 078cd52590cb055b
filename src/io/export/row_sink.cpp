#include "io/export/row_sink.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cstddef>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/export/position_text.hpp"
#include "io/formats/las/las_writer.hpp"
#include "io/formats/ply/ply_writer.hpp"
#include "io/formats/requantize.hpp"
#include "io/formats/text/text_buffer.hpp"
#include "io/formats/text/text_writer.hpp"
#include "io/system/file.hpp"
#include "io/system/file_ending.hpp"

namespace clearway {
namespace {

/// Number of rows that a thread works on at a time.
inline constexpr std::size_t kBlockRows = 1 << 12;

/// Calls work(block, first row, end) for each block of rows, with many threads.
template <typename Work>
void for_each_block(std::size_t rows, Work work) {
  const ParallelScope scope;
  const auto run_block = piece_of(scope, [&](std::size_t block) {
    work(block, block * kBlockRows, std::min(rows, (block + 1) * kBlockRows));
  });
  scope.begin();
  tbb::parallel_for(std::size_t{0}, (rows + kBlockRows - 1) / kBlockRows, run_block);
}

/// Appends rows to a file. Many threads make the texts by write_rows(text, first row, end).
template <typename WriteRows>
void write_blocks(const File& file, std::size_t rows, WriteRows write_rows) {
  std::vector<TextBuffer> blocks((rows + kBlockRows - 1) / kBlockRows);
  for_each_block(rows, [&](std::size_t block, std::size_t first, std::size_t end) {
    write_rows(blocks[block], first, end);
  });
  for (const TextBuffer& block : blocks) file.write(std::as_bytes(std::span(block.text())));
}

using Quanta = std::vector<std::array<std::int32_t, 3>>;

/// Finds the stored integers of a position; returns false where a coordinate is not on the scale.
bool set_quanta(const Quantisation& quantisation, const Vec3& p, std::array<std::int32_t, 3>& out) {
  for (int k = 0; k < 3; ++k) {
    const auto q = quantum_at(quantisation, k, p[k]);
    if (!q) return false;
    out[static_cast<std::size_t>(k)] = *q;
  }
  return true;
}

Quanta quanta_of(const ExportTable& table, const ExportRows& rows) {
  const Quantisation& quantisation = table.result.header().quantisation;
  Quanta out(rows.xyz.size());
  std::atomic<std::size_t> first_wrong = out.size();
  for_each_block(out.size(), [&](std::size_t, std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      if (set_quanta(quantisation, rows.xyz[i], out[i])) continue;
      std::size_t seen = first_wrong;
      while (i < seen && !first_wrong.compare_exchange_weak(seen, i)) {
      }
      return;
    }
  });
  if (first_wrong == out.size()) return out;
  throw InputError(table.result.name() + ": /" + table.group + "/xyz, source " +
                   std::to_string(rows.source[first_wrong]) +
                   ": expected a whole multiple of the scale above the offset");
}

class LasSink final : public RowSink {
 public:
  LasSink(const ExportTable& table, const File& file)
      : table_(table), writer_(file, header_of(table)) {}

  void write(const ExportRows& rows) override {
    writer_.write(quanta_of(table_, rows), {rows.first_pose, rows.distance, rows.pose, rows.body});
  }
  void finish() override { writer_.finish(); }

 private:
  static LasHeader header_of(const ExportTable& table) {
    const ResultHeader& header = table.result.header();
    return {header.quantisation, table.rows,     table.bounds, header.crs_wkt,
            table.first_pose,    table.distance, table.body};
  }

  const ExportTable table_;
  LasWriter writer_;
};

class PlySink final : public RowSink {
 public:
  PlySink(const ExportTable& table, const File& file)
      : writer_(file, PlyOutput{.points = table.rows,
                                .coordinates = PlyCoordinates::kFloat64,
                                .first_pose = table.first_pose,
                                .distance = table.distance,
                                .body = table.body}) {}

  void write(const ExportRows& rows) override {
    writer_.write(rows.xyz, {rows.first_pose, rows.distance, rows.pose, rows.body});
  }
  void finish() override { writer_.finish(); }

 private:
  PlyWriter writer_;
};

class XyzSink final : public RowSink {
 public:
  XyzSink(const ExportTable& table, const File& file)
      : file_(file), position_(table.result.header().quantisation) {}

  void write(const ExportRows& rows) override {
    write_blocks(file_, rows.xyz.size(), [&](TextBuffer& out, std::size_t first, std::size_t end) {
      PositionText position = position_;
      for (std::size_t i = first; i < end; ++i) {
        position.write(out, rows.xyz[i], " ");
        if (!rows.distance.empty()) out << " " << rows.distance[i] << " " << rows.pose[i];
        out << "\n";
      }
    });
  }
  void finish() override {}

 private:
  const File& file_;
  const PositionText position_;
};

/// Writes CSV. The clearances of a result of version 2 have no coordinates.
class CsvSink final : public RowSink {
 public:
  CsvSink(const ExportTable& table, const File& file)
      : file_(file), position_(table.result.header().quantisation) {
    TextWriter out(file);
    out << "source";
    if (!table.distance || table.result.header().has_clearance_xyz()) out << ",x,y,z";
    if (table.first_pose) out << ",first_pose";
    if (table.distance) out << ",distance,pose";
    if (table.body) out << ",body";
    out << "\n";
    out.flush();
  }

  void write(const ExportRows& rows) override {
    write_blocks(file_, rows.source.size(),
                 [&](TextBuffer& out, std::size_t first, std::size_t end) {
                   PositionText position = position_;
                   for (std::size_t i = first; i < end; ++i) write_row(rows, i, position, out);
                 });
  }
  void finish() override {}

 private:
  static void write_row(const ExportRows& rows, std::size_t i, PositionText& position,
                        TextBuffer& out) {
    out << rows.source[i];
    if (!rows.xyz.empty()) position.write(out << ",", rows.xyz[i], ",");
    if (!rows.first_pose.empty()) out << "," << rows.first_pose[i];
    if (!rows.distance.empty()) out << "," << rows.distance[i] << "," << rows.pose[i];
    if (!rows.body.empty()) out << "," << rows.body[i];
    out << "\n";
  }

  const File& file_;
  const PositionText position_;
};

}  // namespace

ExportFormat export_format_of(const std::filesystem::path& output) {
  const std::string ending = file_ending(output);
  if (ending == ".las") return ExportFormat::kLas;
  if (ending == ".ply") return ExportFormat::kPly;
  if (ending == ".xyz") return ExportFormat::kXyz;
  if (ending == ".csv") return ExportFormat::kCsv;
  throw UsageError(output.string() +
                   ": unknown output format; the name must end in .las, .ply, .xyz or .csv");
}

std::unique_ptr<RowSink> make_row_sink(ExportFormat format, const ExportTable& table,
                                       const File& file) {
  switch (format) {
    case ExportFormat::kLas:
      return std::make_unique<LasSink>(table, file);
    case ExportFormat::kPly:
      return std::make_unique<PlySink>(table, file);
    case ExportFormat::kXyz:
      return std::make_unique<XyzSink>(table, file);
    case ExportFormat::kCsv:
      break;
  }
  return std::make_unique<CsvSink>(table, file);
}

void unite_rows(const ExportTable& table, const ExportRows& rows, bool& any, QuantumBox& box) {
  for (const auto& [x, y, z] : quanta_of(table, rows)) {
    const QuantumBox point{{x, y, z}, {x, y, z}};
    box = any ? box.united(point) : point;
    any = true;
  }
}

}  // namespace clearway
