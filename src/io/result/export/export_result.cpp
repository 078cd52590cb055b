#include "io/result/export/export_result.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/result.hpp"
#include "core/describe/labels.hpp"
#include "io/files/file.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/text_writer.hpp"
#include "io/result/export/position_text.hpp"
#include "io/result/result.hpp"
#include "io/scans/las/las_writer.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/ply/ply_writer.hpp"
#include "io/scans/requantize.hpp"

namespace clearway {
namespace {

/// Number of rows that a thread works on at a time.
inline constexpr std::size_t kBlockRows = 1 << 12;

/// Calls work(block, first row, end) for each block of rows, with many threads.
template <typename Work>
void for_each_block(std::size_t rows, Work work) {
  for_each_parallel((rows + kBlockRows - 1) / kBlockRows, [&](std::size_t block) {
    work(block, block * kBlockRows, std::min(rows, (block + 1) * kBlockRows));
  });
}

/// Appends rows to a file. Many threads format them with write_rows(text, first row, end).
template <typename WriteRows>
void write_blocks(const File& file, std::size_t rows, WriteRows write_rows) {
  std::vector<TextBuffer> blocks((rows + kBlockRows - 1) / kBlockRows);
  for_each_block(rows, [&](std::size_t block, std::size_t first, std::size_t end) {
    write_rows(blocks[block], first, end);
  });
  for (const TextBuffer& block : blocks) file.write(std::as_bytes(std::span(block.text())));
}

/// The unit of a result that is not in metres, as a reader of files finds it; empty in metres,
/// which every reader takes by default, and where the unit is not known.
std::string unit_to_name(const ResultHeader& header) {
  const double metres = metres_of(length_unit_of(header.notes.length_unit));
  return metres == 0 || metres == 1 ? std::string() : symbol_of(FileUnit::exactly(metres));
}

/// x, y and z with the unit, where it has to be named.
std::string position_columns(const ResultHeader& header, const std::string& separator) {
  const std::string name = unit_to_name(header);
  const std::string unit = name.empty() ? "" : " [" + name + "]";
  return "x" + unit + separator + "y" + unit + separator + "z" + unit;
}

/// The CRS of a result. Where only a unit is known, it becomes that of a local system.
std::string crs_of(const ResultHeader& header) {
  if (!header.crs_wkt.empty() || unit_to_name(header).empty()) return header.crs_wkt;
  return local_system(length_unit_of(header.notes.length_unit));
}

PlyOutput ply_of(const ResultHeader& header, std::uint64_t points, std::vector<PointField> fields) {
  PlyOutput out{.points = points, .fields = std::move(fields)};
  const std::string unit = unit_to_name(header);
  if (!unit.empty()) out.comments.push_back(std::string(kUnitComment) + unit);
  return out;
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

/// The values of the columns of fields_of().
template <typename Rows>
std::vector<FieldValues> values_of(const ResultHeader& header, const Rows& rows) {
  std::vector<FieldValues> out;
  out.reserve(kColumnsOf<Rows>);
  for_each_column<Rows>([&](const auto& column) {
    using Value = typename std::decay_t<decltype(column)>::Value;
    if constexpr (std::is_constructible_v<FieldValues, std::span<const Value>>) {
      if (column.field == nullptr || !column.is_in(header)) return;
      out.emplace_back(std::span<const Value>(rows.*column.values));
    }
  });
  return out;
}

/// Receives the rows of a table front to back and writes them in a format. `Rows` is Collisions,
/// Nearby or Clearances. Coordinates are written as they are stored, and the columns that the
/// schema names as fields follow them.
template <typename Rows>
class RowSink {
 public:
  virtual ~RowSink() = default;
  virtual void write(const Rows& rows) = 0;
  virtual void finish() {}
};

template <typename Rows>
class LasSink final : public RowSink<Rows> {
 public:
  LasSink(const ResultReader& result, const File& file)
      : result_(result),
        writer_(file,
                LasFormat::of_points(result.header().quantisation, result.rows<Rows>(),
                                     crs_of(result.header()), fields_of<Rows>(result.header()))) {}

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
        writer_(file,
                ply_of(result.header(), result.rows<Rows>(), fields_of<Rows>(result.header()))) {}

  void write(const Rows& rows) override {
    writer_.write(rows.xyz, values_of(result_.header(), rows));
  }
  void finish() override { writer_.finish(); }

 private:
  const ResultReader& result_;
  PlyWriter writer_;
};

/// Writes coordinates, and after those of clearances the distance and its pose.
template <typename Rows>
class XyzSink final : public RowSink<Rows> {
 public:
  XyzSink(const ResultReader& result, const File& file)
      : file_(file), position_(result.header().quantisation) {
    if (unit_to_name(result.header()).empty()) return;
    TextWriter out(file);
    out << "# " << position_columns(result.header(), " ") << "\n";
    out.flush();
  }

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

 private:
  const File& file_;
  const PositionText position_;
};

template <typename Number>
void write_cell(TextBuffer& out, Number value) {
  out << value;
}
void write_cell(TextBuffer& out, std::uint8_t value) { out << std::uint32_t{value}; }
/// What a row does not have, such as the depth of a point where none is free, is an empty cell.
void write_cell(TextBuffer& out, double value) {
  if (!std::isnan(value)) out << value;
}
void write_cell(TextBuffer& out, std::uint64_t value) {
  if (value != Collisions::kNoPoint) out << value;
}

/// Writes source, coordinates and fields.
template <typename Rows>
class CsvSink final : public RowSink<Rows> {
 public:
  CsvSink(const ResultReader& result, const File& file)
      : header_(result.header()), file_(file), position_(result.header().quantisation) {
    TextWriter out(file);
    out << "source";
    for_each_column<Rows>([&](const auto& column) {
      if (!column.is_in(header_)) return;
      if (std::string_view(column.dataset) == "xyz") {
        out << "," << position_columns(header_, ",");
      }
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
        position.write(out << ",", rows.xyz[i], ",");
        for (const FieldValues& field : values) {
          std::visit([&](const auto& of_points) { write_cell(out << ",", of_points[i]); }, field);
        }
        out << "\n";
      }
    });
  }

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

namespace {

/// The result and the file must outlive the sink.
template <typename Rows>
std::unique_ptr<RowSink<Rows>> make_row_sink(ExportFormat format, const ResultReader& result,
                                             const File& file) {
  switch (format) {
    case ExportFormat::kLas:
      return std::make_unique<LasSink<Rows>>(result, file);
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
void export_table(const ResultReader& result, const std::filesystem::path& output, bool overwrite,
                  Progress& progress) {
  const ExportFormat format = export_format_of(output);
  refuse_overwriting(output, {result.name()});
  PendingFile pending(output, overwrite);
  {
    const File file = File::create(pending.partial());
    const auto sink = make_row_sink<Rows>(format, result, file);
    progress.begin("export", result.rows<Rows>(), "points");
    RowStream<Rows> stream(result);
    for (Rows rows; stream.read(rows);) {
      throw_if_stopped(progress);
      sink->write(rows);
      progress.advance(rows.size());
    }
    sink->finish();
    progress.end();
  }
  pending.publish();
}

}  // namespace

void export_result(const ResultReader& result, const std::filesystem::path& output, bool overwrite,
                   Progress& progress) {
  export_table<Collisions>(result, output, overwrite, progress);
}

void export_near(const ResultReader& result, const std::filesystem::path& output, bool overwrite,
                 Progress& progress) {
  if (!result.header().budget) {
    throw UsageError(result.name() +
                     ": has no near points, because its run had no error budget; expected a run "
                     "with an error, such as that of the scan");
  }
  export_table<Nearby>(result, output, overwrite, progress);
}

void export_clearances(const ResultReader& result, const std::filesystem::path& output,
                       bool overwrite, Progress& progress) {
  if (!(result.header().clearance > 0)) {
    throw UsageError(result.name() + ": has no clearances", Remedy::kAskForClearance);
  }
  export_table<Clearances>(result, output, overwrite, progress);
}

namespace {

class ProfileTable {
 public:
  ProfileTable(const File& file, const ResultReader& result, const PoseLabels& labels,
               double chainage_start)
      : out_(file),
        position_(result.header().quantisation),
        labels_(labels),
        chainage_start_(chainage_start),
        has_bodies_(!result.header().bodies.empty()),
        has_classes_(result.header().has_classes()),
        unsearched_(result.findings().without_bodies) {
    out_ << "pose";
    for_each_label([&](const auto& label) {
      if (!label.of(labels).empty()) out_ << "," << label.key;
    });
    out_ << ",chainage,distance,source,x,y,z" << (has_classes_ ? ",class" : "")
         << (has_bodies_ ? ",searched\n" : "\n");
  }

  void write(const ProfileRows& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i, ++pose_) {
      out_ << pose_;
      for_each_label([&](const auto& label) {
        if (!label.of(labels_).empty()) out_ << "," << label_cell(label.of(labels_)[pose_]);
      });
      out_ << "," << chainage_start_ + rows.chainage[i] << ",";
      if (rows.source[i] == Profile::kNoPoint) {
        out_ << ",,,," << (has_classes_ ? "," : "");
        end_row();
        continue;
      }
      out_ << rows.distance[i] << "," << rows.source[i] << ",";
      position_.write(out_, rows.xyz[i], ",");
      if (has_classes_) out_ << "," << std::uint32_t{rows.point_class[i]};
      end_row();
    }
  }
  void finish() { out_.flush(); }

 private:
  void end_row() {
    while (next_ < unsearched_.size() && unsearched_[next_][1] < pose_) ++next_;
    const bool searched = next_ == unsearched_.size() || pose_ < unsearched_[next_][0];
    out_ << (!has_bodies_ ? "\n" : searched ? ",1\n" : ",0\n");
  }

  TextWriter out_;
  PositionText position_;
  const PoseLabels& labels_;
  double chainage_start_;
  bool has_bodies_, has_classes_;
  const std::vector<std::array<std::uint32_t, 2>>& unsearched_;
  /// Index of the first run of unsearched_ that does not end before the pose.
  std::size_t next_ = 0;
  std::uint64_t pose_ = 0;
};

}  // namespace

void export_profile(const ResultReader& result, const PoseLabels& labels, double chainage_start,
                    const std::filesystem::path& output, bool overwrite, Progress& progress) {
  if (!(result.header().profile > 0)) {
    throw UsageError(result.name() + ": has no profile", Remedy::kAskForProfile);
  }
  if (export_format_of(output) != ExportFormat::kCsv) {
    throw UsageError(output.string() + ": a profile is exported as .csv only");
  }
  for_each_label([&](const auto& label) {
    const std::size_t count = label.of(labels).size();
    if (count != 0 && count != result.profile_rows()) {
      throw std::logic_error("export_profile: labels of another number of poses");
    }
  });
  refuse_overwriting(output, {result.name()});
  PendingFile pending(output, overwrite);
  {
    const File file = File::create(pending.partial());
    ProfileTable table(file, result, labels, chainage_start);
    progress.begin("export", result.profile_rows(), "poses");
    RowStream<ProfileRows> stream(result);
    for (ProfileRows rows; stream.read(rows);) {
      throw_if_stopped(progress);
      table.write(rows);
      progress.advance(rows.size());
    }
    table.finish();
    progress.end();
  }
  pending.publish();
}

}  // namespace clearway
