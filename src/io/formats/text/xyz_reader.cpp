#include "io/formats/text/xyz_reader.hpp"

#include <utility>

#include "clearway/error.hpp"
#include "io/formats/text/point_line.hpp"
#include "io/formats/text/xyz_prologue.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

class XyzReader final : public PointReader {
 public:
  XyzReader(InputBuffer input, const PointReadOptions& options)
      : input_(std::move(input)), may_choose_(options.may_choose) {
    XyzPrologue prologue = read_xyz_prologue(input_, options);
    line_ = std::move(prologue.line);
    fields_ = prologue.fields;
    info_.declared_points = prologue.declared_points;
    info_.unit = prologue.unit;
    info_.remarks = std::move(prologue.remarks);
    info_.text_table = true;
    remarks_at_start_ = info_.remarks.size();
    first_point_ = input_.mark();
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.quanta.clear();
    batch.absent.clear();
    batch.positions.clear();
    std::string_view line;
    while (batch.positions.size() < kBatchPoints && next_data_line(input_, line)) {
      if (next_ == info_.declared_points) {
        fail("more than the " + std::to_string(next_) + " points that the first line declares");
      }
      Vec3 point{};
      if (!line_.parse(line, point)) refuse_point(line);
      batch.positions.push_back(point);
      if (!input_.line_terminated()) check_open_end(line);
      ++next_;
    }
    if (batch.positions.size() < kBatchPoints) check_count();
    return !batch.positions.empty();
  }

  void rewind() override {
    input_.return_to(first_point_);
    info_.remarks.resize(remarks_at_start_);
    next_ = 0;
  }

  std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> points) override {
    rewind();
    std::vector<std::uint64_t> lines;
    std::string_view line;
    for (; lines.size() < points.size() && next_data_line(input_, line); ++next_) {
      if (next_ == points[lines.size()]) lines.push_back(input_.line());
    }
    return lines;
  }

 private:
  [[noreturn]] void fail(const std::string& what, Remedy remedy = Remedy::kNone) const {
    refuse_line(input_.name(), input_.line(), what, remedy);
  }

  [[noreturn]] void refuse_point(std::string_view line) const {
    std::string where = "the coordinates x y z";
    if (line_.columns() != kFirstThree) {
      where = "in columns";
      for (const std::size_t column : line_.columns()) where += " " + std::to_string(column + 1);
    }
    fail(excerpt(line) + decimal_commas_in(line) + "; expected three numbers, " + where +
             ", in blanks, commas or semicolons",
         next_ == 0 && may_choose_ ? Remedy::kColumns : Remedy::kNone);
  }

  /// The last line has no line break. It counts where no value is missing.
  void check_open_end(std::string_view line) {
    const std::size_t found = count_fields(line);
    const std::string what = "the file ends without a line break";
    if (line.ends_with('.') && info_.declared_points) {
      fail(what + " within a number; expected all of it");
    }
    if (found >= fields_) {
      if (!info_.declared_points) return;
      info_.remarks.push_back(
          {Message::Severity::kNote, "no-line-break", input_.name() + ": " + what, {}});
      return;
    }
    const std::string cut = what + " after " + std::to_string(found) + " of " +
                            std::to_string(fields_) + " values, so it may be cut";
    if (info_.declared_points) fail(cut + "; expected all values of the last line");
    info_.remarks.push_back({Message::Severity::kWarning,
                             "cut-text",
                             input_.name() + ": " + cut,
                             {{"line", static_cast<double>(input_.line())}}});
  }

  void check_count() const {
    if (info_.declared_points && next_ != *info_.declared_points) {
      refuse(input_.name(), "ends after line " + std::to_string(input_.line()) + " with " +
                                std::to_string(next_) + " points; expected " +
                                std::to_string(*info_.declared_points) +
                                " as the first line declares");
    }
  }

  InputBuffer input_;
  bool may_choose_;
  CloudInfo info_;
  PointLine line_;
  std::size_t fields_ = 0;  ///< of the first point's line
  std::size_t remarks_at_start_ = 0;
  InputBuffer::Mark first_point_;
  std::uint64_t next_ = 0;  ///< number of points read
};

}  // namespace

std::unique_ptr<PointReader> read_xyz(InputBuffer input, const PointReadOptions& options) {
  if (!options.columns.empty() && options.columns.size() != 3) {
    throw UsageError(std::to_string(options.columns.size()) +
                     " columns chosen; expected three, of x, y and z");
  }
  return std::make_unique<XyzReader>(std::move(input), options);
}

}  // namespace clearway
