#include <algorithm>
#include <utility>

#include "core/util/format.hpp"
#include "io/formats/ptx/ptx_reader.hpp"
#include "io/formats/ptx/scan_lines.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

class PtsReader final : public PointReader {
 public:
  PtsReader(InputBuffer input, std::vector<Message> remarks)
      : input_(std::move(input)), remarks_(std::move(remarks)) {
    input_.skip_byte_order_mark();
    start_ = input_.mark();
    std::string_view line;
    if (!next_scan_line(input_, line)) refuse(input_.name(), "is empty; expected points");
    begin_scan(line);
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.quanta.clear();
    batch.absent.clear();
    batch.positions.resize(kBatchPoints);
    std::size_t count = 0;
    std::string_view line;
    while (count < kBatchPoints && next_scan_line(input_, line)) {
      if (left_ == 0) {
        begin_scan(line);
      } else {
        read_point(line, batch.positions[count++]);
      }
    }
    batch.positions.resize(count);
    if (count < kBatchPoints) check_count();
    if (count == 0) finish();
    return count > 0;
  }

  void rewind() override {
    input_.return_to(start_);
    scans_ = left_ = declared_ = 0;
    open_end_ = {};
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    refuse_line(input_.name(), input_.line(), what);
  }

  void begin_scan(std::string_view line) {
    const auto count = count_in(line);
    if (!count && scans_ == 0) fail(excerpt(line) + "; expected the number of points");
    if (!count) {
      fail("more than the " + std::to_string(points_) + " points that line " +
           std::to_string(count_line_) + " declares");
    }
    if (*count > most_scan_points(input_)) {
      fail("declares " + format_count(*count) + " points, for which the file of " +
           format_count(*input_.size()) + " bytes is too short; expected a line for each");
    }
    points_ = left_ = *count;
    declared_ += *count;
    count_line_ = input_.line();
    ++scans_;
    info_.declared_points = std::max(info_.declared_points.value_or(0), declared_);
  }

  void read_point(std::string_view line, Vec3& point) {
    if (!parse_scan_point(line, point)) {
      fail(excerpt(line) + " after " + std::to_string(points_ - left_) + " of the " +
           std::to_string(points_) + " points that line " + std::to_string(count_line_) +
           " declares; expected three numbers, the coordinates x y z");
    }
    open_end_.see(input_, line);
    --left_;
  }

  void check_count() const {
    if (left_ == 0) return;
    refuse(input_.name(), "ends after line " + std::to_string(input_.line()) + " with " +
                              std::to_string(points_ - left_) + " points; expected " +
                              std::to_string(points_) + " as line " + std::to_string(count_line_) +
                              " declares");
  }

  void finish() {
    info_.remarks = remarks_;
    if (scans_ > 1) {
      info_.remarks.push_back({Message::Severity::kNote,
                               "several-counts",
                               input_.name() + ": " + format_count(scans_) +
                                   " scans one after the other, each with its number of points",
                               {{"scans", static_cast<double>(scans_)}}});
    }
    open_end_.append_to(info_.remarks, input_.name());
  }

  InputBuffer input_;
  std::vector<Message> remarks_;  ///< known before reading
  CloudInfo info_;
  InputBuffer::Mark start_;
  std::uint64_t scans_ = 0;
  std::uint64_t points_ = 0;      ///< of the scan
  std::uint64_t left_ = 0;        ///< of them not read yet
  std::uint64_t declared_ = 0;    ///< of all scans so far
  std::uint64_t count_line_ = 0;  ///< where points_ stands
  OpenEnd open_end_;
};

}  // namespace

std::unique_ptr<PointReader> read_pts(InputBuffer input, std::vector<Message> remarks) {
  return std::make_unique<PtsReader>(std::move(input), std::move(remarks));
}

}  // namespace clearway
