#include "io/export/export_profile.hpp"

#include <stdexcept>
#include <string>

#include "clearway/error.hpp"
#include "clearway/result.hpp"
#include "io/export/position_text.hpp"
#include "io/export/row_sink.hpp"
#include "io/formats/text/csv_cell.hpp"
#include "io/formats/text/text_writer.hpp"
#include "io/result/result.hpp"
#include "io/system/pending_file.hpp"

namespace clearway {
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
        unsearched_(result.findings().without_bodies) {
    out_ << "pose";
    if (!labels.time.empty()) out_ << ",time";
    if (!labels.name.empty()) out_ << ",name";
    out_ << ",chainage,distance,source,x,y,z" << (has_bodies_ ? ",searched\n" : "\n");
  }

  void write(const ProfileRows& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i, ++pose_) {
      out_ << pose_;
      if (!labels_.time.empty()) out_ << "," << labels_.time[pose_];
      if (!labels_.name.empty()) out_ << "," << csv_cell(labels_.name[pose_]);
      out_ << "," << chainage_start_ + rows.chainage[i] << ",";
      if (rows.source[i] == Profile::kNoPoint) {
        out_ << ",,,,";
        end_row();
        continue;
      }
      out_ << rows.distance[i] << "," << rows.source[i] << ",";
      position_.write(out_, rows.xyz[i], ",");
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
  bool has_bodies_;
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
  for (const std::size_t count : {labels.time.size(), labels.name.size()}) {
    if (count != 0 && count != result.profile_rows()) {
      throw std::logic_error("export_profile: labels of another number of poses");
    }
  }
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
