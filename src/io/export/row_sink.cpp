#include "io/export/row_sink.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
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

template <typename Rows>
Quanta quanta_of(const ResultReader& result, const Rows& rows) {
  const Quantisation& quantisation = result.header().quantisation;
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
  throw InputError(result.name() + ": /" + Table<Rows>::kGroup + "/xyz, source " +
                   std::to_string(rows.source[first_wrong]) +
                   ": expected a whole multiple of the scale above the offset");
}

/// The columns of a table that are exported as fields of its points.
template <typename Rows>
std::vector<PointField> fields_of(const ResultHeader& header) {
  std::vector<PointField> out;
  for_each_column<Rows>([&](const auto& column) {
    if (column.field == nullptr || !column.is_in(header)) return;
    using Value = typename std::decay_t<decltype(column)>::Value;
    out.push_back(
        {column.dataset,
         std::is_same_v<Value, double> ? PointField::Type::kDouble : PointField::Type::kUint32,
         column.field});
  });
  return out;
}

/// The values of those columns.
template <typename Rows>
std::vector<FieldValues> values_of(const ResultHeader& header, const Rows& rows) {
  std::vector<FieldValues> out;
  for_each_column<Rows>([&](const auto& column) {
    using Value = typename std::decay_t<decltype(column)>::Value;
    if constexpr (std::is_constructible_v<FieldValues, std::span<const Value>>) {
      if (column.field == nullptr || !column.is_in(header)) return;
      out.emplace_back(std::span<const Value>(rows.*column.values));
    }
  });
  return out;
}

template <typename Rows>
class LasSink final : public RowSink<Rows> {
 public:
  LasSink(const ResultReader& result, const QuantumBox& bounds, const File& file)
      : result_(result),
        writer_(file, {result.header().quantisation, result.rows<Rows>(), bounds,
                       result.header().crs_wkt, fields_of<Rows>(result.header())}) {}

  void write(const Rows& rows) override {
    writer_.write(quanta_of(result_, rows), values_of(result_.header(), rows));
  }
  void finish() override { writer_.finish(); }

 private:
  const ResultReader& result_;
  LasWriter writer_;
};

template <typename Rows>
class PlySink final : public RowSink<Rows> {
 public:
  PlySink(const ResultReader& result, const File& file)
      : result_(result),
        writer_(file, {.points = result.rows<Rows>(), .fields = fields_of<Rows>(result.header())}) {
  }

  void write(const Rows& rows) override {
    writer_.write(rows.xyz, values_of(result_.header(), rows));
  }
  void finish() override { writer_.finish(); }

 private:
  const ResultReader& result_;
  PlyWriter writer_;
};

/// Writes coordinates, and behind those of clearances the distance and its pose.
template <typename Rows>
class XyzSink final : public RowSink<Rows> {
 public:
  XyzSink(const ResultReader& result, const File& file)
      : file_(file), position_(result.header().quantisation) {}

  void write(const Rows& rows) override {
    write_blocks(file_, rows.xyz.size(), [&](TextBuffer& out, std::size_t first, std::size_t end) {
      PositionText position = position_;
      for (std::size_t i = first; i < end; ++i) {
        position.write(out, rows.xyz[i], " ");
        if constexpr (std::is_same_v<Rows, Clearances>) {
          out << " " << rows.distance[i] << " " << rows.pose[i];
        }
        out << "\n";
      }
    });
  }
  void finish() override {}

 private:
  const File& file_;
  const PositionText position_;
};

/// Writes source, coordinates and fields. The clearances of a result of version 2 have no
/// coordinates.
template <typename Rows>
class CsvSink final : public RowSink<Rows> {
 public:
  CsvSink(const ResultReader& result, const File& file)
      : header_(result.header()), file_(file), position_(result.header().quantisation) {
    TextWriter out(file);
    out << "source";
    for_each_column<Rows>([&](const auto& column) {
      if (!column.is_in(header_)) return;
      if (std::string_view(column.dataset) == result_names::kXyz) out << ",x,y,z";
      if (column.field != nullptr) out << "," << column.dataset;
    });
    out << "\n";
    out.flush();
  }

  void write(const Rows& rows) override {
    const std::vector<FieldValues> values = values_of(header_, rows);
    write_blocks(file_, rows.size(), [&](TextBuffer& out, std::size_t first, std::size_t end) {
      PositionText position = position_;
      for (std::size_t i = first; i < end; ++i) {
        out << rows.source[i];
        if (!rows.xyz.empty()) position.write(out << ",", rows.xyz[i], ",");
        for (const FieldValues& field : values) {
          std::visit([&](const auto& of_points) { out << "," << of_points[i]; }, field);
        }
        out << "\n";
      }
    });
  }
  void finish() override {}

 private:
  const ResultHeader& header_;
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

template <typename Rows>
std::unique_ptr<RowSink<Rows>> make_row_sink(ExportFormat format, const ResultReader& result,
                                             const QuantumBox& bounds, const File& file) {
  switch (format) {
    case ExportFormat::kLas:
      return std::make_unique<LasSink<Rows>>(result, bounds, file);
    case ExportFormat::kPly:
      return std::make_unique<PlySink<Rows>>(result, file);
    case ExportFormat::kXyz:
      return std::make_unique<XyzSink<Rows>>(result, file);
    case ExportFormat::kCsv:
      break;
  }
  return std::make_unique<CsvSink<Rows>>(result, file);
}

template <typename Rows>
QuantumBox bounds_of(const ResultReader& result, const Progress& progress) {
  std::optional<QuantumBox> box;
  RowStream<Rows> stream(result);
  for (Rows rows; stream.read(rows);) {
    throw_if_stopped(progress);
    for (const auto& [x, y, z] : quanta_of(result, rows)) {
      const QuantumBox point{{x, y, z}, {x, y, z}};
      box = box ? box->united(point) : point;
    }
  }
  return box.value_or(QuantumBox{});
}

template std::unique_ptr<RowSink<Collisions>> make_row_sink(ExportFormat, const ResultReader&,
                                                            const QuantumBox&, const File&);
template std::unique_ptr<RowSink<Clearances>> make_row_sink(ExportFormat, const ResultReader&,
                                                            const QuantumBox&, const File&);
template QuantumBox bounds_of<Collisions>(const ResultReader&, const Progress&);
template QuantumBox bounds_of<Clearances>(const ResultReader&, const Progress&);

}  // namespace clearway
