#include "io/export/export_result.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <memory>
#include <optional>
#include <string_view>

#include "clearway/error.hpp"
#include "io/export/decimal_axis.hpp"
#include "io/formats/las/las_writer.hpp"
#include "io/formats/ply/ply_writer.hpp"
#include "io/formats/requantize.hpp"
#include "io/formats/text/text_writer.hpp"
#include "io/result/result_rows.hpp"
#include "io/system/pending_file.hpp"

namespace clearway {
namespace {

using Quanta = std::vector<std::array<std::int32_t, 3>>;

Quanta quanta_of(const ResultReader& result, const ResultRows& rows) {
  Quanta out(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const auto q = quantum_at(result.header().quantisation, k, rows.xyz[i][k]);
      if (!q) {
        throw InputError(result.name() + ": /collisions/xyz, source " +
                         std::to_string(rows.source[i]) +
                         ": expected a whole multiple of the scale above the offset");
      }
      out[i][static_cast<std::size_t>(k)] = *q;
    }
  }
  return out;
}

QuantumBox bounds_of(const ResultReader& result, const Progress& progress) {
  std::optional<QuantumBox> box;
  ResultRowStream stream(result);
  for (ResultRows rows; stream.read(rows);) {
    throw_if_stopped(progress);
    for (const auto& [x, y, z] : quanta_of(result, rows)) {
      const QuantumBox point{{x, y, z}, {x, y, z}};
      box = box ? united(*box, point) : point;
    }
  }
  return box.value_or(QuantumBox{});
}

/// Receives the rows front to back.
class RowSink {
 public:
  virtual ~RowSink() = default;
  virtual void write(const ResultRows& rows) = 0;
  virtual void finish() = 0;
};

class LasSink final : public RowSink {
 public:
  LasSink(const ResultReader& result, const File& file, const Progress& progress)
      : result_(result), writer_(file, header_of(result, progress)) {}

  void write(const ResultRows& rows) override {
    writer_.write(quanta_of(result_, rows), rows.first_pose);
  }
  void finish() override { writer_.finish(); }

 private:
  static LasHeader header_of(const ResultReader& result, const Progress& progress) {
    const ResultHeader& header = result.header();
    return {header.quantisation, result.collisions(), bounds_of(result, progress), header.crs_wkt,
            header.first_pose};
  }

  const ResultReader& result_;
  LasWriter writer_;
};

class PlySink final : public RowSink {
 public:
  PlySink(const ResultReader& result, const File& file, const Progress&)
      : writer_(file, PlyOutput{.points = result.collisions(),
                                .coordinates = PlyCoordinates::kFloat64,
                                .first_pose = result.header().first_pose}) {}

  void write(const ResultRows& rows) override { writer_.write(rows.xyz, rows.first_pose); }
  void finish() override { writer_.finish(); }

 private:
  PlyWriter writer_;
};

/// Positions as texts, three numbers and what stands between them.
class PositionText {
 public:
  explicit PositionText(const Quantisation& quantisation)
      : axes_{DecimalAxis(quantisation, 0), DecimalAxis(quantisation, 1),
              DecimalAxis(quantisation, 2)} {}

  void write(TextWriter& out, const Vec3& p, std::string_view between) {
    out << axes_[0].text(p.x) << between << axes_[1].text(p.y) << between << axes_[2].text(p.z);
  }

 private:
  std::array<DecimalAxis, 3> axes_;
};

class XyzSink final : public RowSink {
 public:
  XyzSink(const ResultReader& result, const File& file, const Progress&)
      : out_(file), position_(result.header().quantisation) {}

  void write(const ResultRows& rows) override {
    for (const Vec3& p : rows.xyz) {
      position_.write(out_, p, " ");
      out_ << "\n";
    }
  }
  void finish() override { out_.flush(); }

 private:
  TextWriter out_;
  PositionText position_;
};

class CsvSink final : public RowSink {
 public:
  CsvSink(const ResultReader& result, const File& file, const Progress&)
      : out_(file), position_(result.header().quantisation) {
    out_ << (result.header().first_pose ? "source,x,y,z,first_pose\n" : "source,x,y,z\n");
  }

  void write(const ResultRows& rows) override {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      out_ << rows.source[i] << ",";
      position_.write(out_, rows.xyz[i], ",");
      if (!rows.first_pose.empty()) out_ << "," << rows.first_pose[i];
      out_ << "\n";
    }
  }
  void finish() override { out_.flush(); }

 private:
  TextWriter out_;
  PositionText position_;
};

using MakeSink = std::unique_ptr<RowSink> (*)(const ResultReader&, const File&, const Progress&);

template <typename Sink>
std::unique_ptr<RowSink> make_sink(const ResultReader& result, const File& file,
                                   const Progress& progress) {
  return std::make_unique<Sink>(result, file, progress);
}

std::string ending_of(const std::filesystem::path& output) {
  std::string ending = output.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

MakeSink sink_for(const std::filesystem::path& output) {
  const std::string ending = ending_of(output);
  if (ending == ".las") return make_sink<LasSink>;
  if (ending == ".ply") return make_sink<PlySink>;
  if (ending == ".xyz") return make_sink<XyzSink>;
  if (ending == ".csv") return make_sink<CsvSink>;
  throw UsageError(output.string() +
                   ": unknown output format; the name must end in .las, .ply, .xyz or .csv");
}

}  // namespace

void export_result(const ResultReader& result, const std::filesystem::path& output, bool overwrite,
                   Progress& progress) {
  const MakeSink make = sink_for(output);
  refuse_overwriting(output, {result.name()});
  PendingFile pending(output, overwrite);
  {
    const File file = File::create(pending.partial());
    const auto sink = make(result, file, progress);
    progress.begin("export", result.collisions(), "points");
    ResultRowStream stream(result);
    for (ResultRows rows; stream.read(rows);) {
      throw_if_stopped(progress);
      sink->write(rows);
      progress.advance(rows.size());
    }
    sink->finish();
    progress.end();
  }
  pending.publish();
}

void export_clearances(const ResultReader& result, const std::filesystem::path& output,
                       bool overwrite, Progress& progress) {
  if (!(result.header().clearance > 0)) {
    throw UsageError(result.name() + ": has no clearances", Remedy::kAskForClearance);
  }
  if (ending_of(output) != ".csv") {
    throw UsageError(output.string() + ": clearances are exported as .csv only");
  }
  refuse_overwriting(output, {result.name()});
  PendingFile pending(output, overwrite);
  {
    const File file = File::create(pending.partial());
    TextWriter out(file);
    out << "source,distance,pose\n";
    progress.begin("export", result.clearances(), "points");
    ClearanceRowStream stream(result);
    for (ClearanceRows rows; stream.read(rows);) {
      throw_if_stopped(progress);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        out << rows.source[i] << "," << rows.distance[i] << "," << rows.pose[i] << "\n";
      }
      progress.advance(rows.size());
    }
    out.flush();
    progress.end();
  }
  pending.publish();
}

}  // namespace clearway
