#include "io/formats/ptx/ptx_reader.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/util/format.hpp"
#include "io/formats/ptx/ptx_header.hpp"
#include "io/formats/text/open_end.hpp"
#include "io/formats/text/point_line.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

constexpr double kAxesTolerance = 1e-3;      // greatest difference in a coordinate of an axis
constexpr double kPositionTolerance = 1e-3;  // greatest distance between positions, metres

/// Counts of what deserves a remark, over all scans.
struct PtxFindings {
  std::uint64_t scans = 0, records = 0, absent = 0;
  std::uint64_t not_rigid = 0, contradicting = 0;  // numbers of scans
  PtxHeader first_not_rigid, most_contradicting;

  void add(const PtxHeader& header) {
    ++scans;
    records += header.points;
    if (!header.rigid && ++not_rigid == 1) first_not_rigid = header;
    if (header.axes_differ <= kAxesTolerance && header.position_differs <= kPositionTolerance) {
      return;
    }
    const auto size = [](const PtxHeader& h) {
      return std::max(h.axes_differ, h.position_differs);
    };
    if (++contradicting == 1 || size(header) > size(most_contradicting)) {
      most_contradicting = header;
    }
  }

  void append_to(std::vector<Message>& remarks, const std::string& name) const;
};

double number(std::uint64_t count) { return static_cast<double>(count); }

Message remark_on_scans(const PtxFindings& found, const std::string& name) {
  return {Message::Severity::kNote,
          "scans-placed",
          name + ": " + format_count(found.scans) + (found.scans == 1 ? " scan" : " scans") +
              ", placed by the matrix in the file; " + format_count(found.absent) + " of " +
              format_count(found.records) + " records hold no point",
          {{"scans", number(found.scans)},
           {"absent", number(found.absent)},
           {"records", number(found.records)}}};
}

Message remark_on_stretch(const PtxFindings& found, const std::string& name) {
  const PtxHeader& h = found.first_not_rigid;
  return {Message::Severity::kWarning,
          "scan-not-rigid",
          name + ": " + format_count(found.not_rigid) + " of " + format_count(found.scans) +
              " scans have a matrix that scales, shears or mirrors. The first is at line " +
              std::to_string(h.line) + ": singular values from " + brief(h.stretch[0]) + " to " +
              brief(h.stretch[1]) + ", determinant " + brief(h.determinant) +
              ". The matrices are applied as they are",
          {{"scans", number(found.not_rigid)},
           {"line", number(h.line)},
           {"least", h.stretch[0]},
           {"greatest", h.stretch[1]},
           {"determinant", h.determinant}}};
}

Message remark_on_axes(const PtxFindings& found, const std::string& name) {
  const PtxHeader& h = found.most_contradicting;
  return {Message::Severity::kWarning,
          "scan-axes-contradict",
          name + ": the scanner's position and axes contradict the matrix in " +
              format_count(found.contradicting) + " of " + format_count(found.scans) +
              " scans. In the one at line " + std::to_string(h.line) + " the positions are " +
              brief(h.position_differs) + " apart, and the axes differ by " + brief(h.axes_differ) +
              ". The matrix is applied",
          {{"scans", number(found.contradicting)},
           {"line", number(h.line)},
           {"position", h.position_differs},
           {"axes", h.axes_differ}}};
}

void PtxFindings::append_to(std::vector<Message>& remarks, const std::string& name) const {
  remarks.push_back(remark_on_scans(*this, name));
  if (not_rigid > 0) remarks.push_back(remark_on_stretch(*this, name));
  if (contradicting > 0) remarks.push_back(remark_on_axes(*this, name));
}

class PtxReader final : public PointReader {
 public:
  PtxReader(InputBuffer input, std::vector<Message> remarks)
      : input_(std::move(input)), remarks_(std::move(remarks)) {
    input_.skip_byte_order_mark();
    start_ = input_.mark();
    if (!next_scan()) refuse(input_.name(), "holds no scan; expected PTX, columns and rows first");
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.quanta.clear();
    batch.positions.clear();
    batch.absent.clear();
    while (batch.positions.size() < kBatchPoints) {
      if (left_ == 0) {
        if (!next_scan()) break;
        continue;
      }
      const auto index = static_cast<std::uint32_t>(batch.positions.size());
      if (!read_point(batch.positions.emplace_back())) batch.absent.push_back(index);
    }
    findings_.absent += batch.absent.size();
    if (batch.positions.empty()) finish();
    return !batch.positions.empty();
  }

  void rewind() override {
    input_.return_to(start_);
    findings_ = {};
    open_end_ = OpenEnd();
    left_ = 0;
  }

  std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> points) override {
    rewind();
    Vec3 point{};
    return lines_of_points(points, input_, [&] {
      while (left_ == 0) {
        if (!next_scan()) return false;
      }
      read_point(point);
      return true;
    });
  }

 private:
  bool next_scan() {
    const auto header = read_ptx_header(input_);
    if (!header) return false;
    check_room(*header);
    scan_ = *header;
    left_ = scan_.points;
    findings_.add(scan_);
    return true;
  }

  void check_room(const PtxHeader& header) const {
    if (header.points <= most_points_in_rest(input_)) return;
    refuse_line(input_.name(), header.line,
                "a scan of " + format_count(header.points) + " points, for which the file of " +
                    format_count(*input_.size()) + " bytes is too short; expected a line for each");
  }

  std::string place() const {
    return std::to_string(scan_.points - left_) + " of " + std::to_string(scan_.points) +
           " points of the scan at line " + std::to_string(scan_.line);
  }

  /// Reads a record; returns false for one without a point.
  bool read_point(Vec3& point) {
    std::string_view line;
    if (!next_data_line(input_, line)) {
      refuse(input_.name(), "ends after line " + std::to_string(input_.line()) + " with " +
                                place() + "; expected all of them");
    }
    if (!parse_point(line, point)) {
      refuse_line(
          input_.name(), input_.line(),
          excerpt(line) + " after " + place() + "; expected three numbers, the coordinates x y z");
    }
    open_end_.see(input_, line);
    --left_;
    if (point.x == 0 && point.y == 0 && point.z == 0) {
      constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
      point = {kNaN, kNaN, kNaN};
      return false;
    }
    point = scan_.place(point);
    return true;
  }

  void finish() {
    info_.remarks = remarks_;
    findings_.append_to(info_.remarks, input_.name());
    open_end_.append_to(info_.remarks, input_.name());
  }

  InputBuffer input_;
  std::vector<Message> remarks_;  ///< remarks known before reading
  CloudInfo info_;
  InputBuffer::Mark start_;
  PtxHeader scan_;
  std::uint64_t left_ = 0;  ///< points of the current scan that are not read yet
  PtxFindings findings_;
  OpenEnd open_end_;
};

}  // namespace

std::unique_ptr<PointReader> read_ptx(InputBuffer input, std::vector<Message> remarks) {
  return std::make_unique<PtxReader>(std::move(input), std::move(remarks));
}

}  // namespace clearway
