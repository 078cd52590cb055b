#include "io/scans/text/xyz_reader.hpp"

#include <algorithm>
#include <utility>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/text/point_blocks.hpp"
#include "io/scans/text/xyz_prologue.hpp"

namespace clearway {
namespace {

constexpr const char* kNoLineBreak = "the file ends without a line break";

std::string missing(std::size_t found, std::size_t values) {
  return fmt::format("{} after {} of {} values, so it may be cut", kNoLineBreak, found, values);
}

}  // namespace

void OpenEnd::look(const InputBuffer& input, std::string_view line) {
  const std::size_t found = count_fields(line);
  if (values_ == 0) values_ = found;
  if (input.line_terminated()) return;
  found_ = found;
  line_ = input.line();
  if (!counted_) return;
  if (found < values_) {
    refuse_line(input.name(), line_,
                missing(found, values_) + "; expected all values of the last line");
  }
  if (line.ends_with('.')) {
    refuse_line(input.name(), line_, "{} within a number; expected all of it", kNoLineBreak);
  }
}

void OpenEnd::append_to(std::vector<Message>& remarks, const std::string& name) const {
  if (line_ == 0 || counted_ || found_ >= values_) return;
  remarks.push_back(warning("cut-text", name + ": " + missing(found_, values_), {{"line", line_}}));
}

namespace {

class XyzReader final : public PointReader {
 public:
  /// may_choose: whether the caller may choose columns, which a refusal then advises.
  XyzReader(InputBuffer input, XyzPrologue prologue, bool may_choose)
      : input_(std::move(input)),
        may_choose_(may_choose),
        prologue_(std::move(prologue)),
        remarks_at_start_(info_.remarks.size()),
        first_point_(input_.mark()) {
    start();
    if (is_counted()) check_room();
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.clear();
    while (batch.positions.size() < kBatchPoints) {
      if (blocks_.take(batch.positions, kBatchPoints) > 0 || read_blocks()) continue;
      if (!read_line(batch)) break;
    }
    if (batch.positions.size() < kBatchPoints) finish();
    return !batch.positions.empty();
  }

  void rewind() override {
    input_.return_to(first_point_);
    info_.remarks.resize(remarks_at_start_);
    start();
  }

  std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> points) override {
    rewind();
    std::string_view line;
    return lines_of_points(points, input_, [&] { return next_point_line(line); });
  }

 private:
  /// The number of points that a line declares to follow it.
  struct Count {
    std::uint64_t points = 0;
    std::uint64_t line = 0;  ///< line of the number; 0 where the text declares none
  };

  bool is_counted() const { return first_.line > 0; }

  bool read_line(PointBatch& batch) {
    std::string_view line;
    if (!next_point_line(line)) return false;
    Vec3 point{};
    if (!prologue_.line.parse(line, point)) refuse_point(line);
    batch.positions.push_back(point);
    open_end_.see(input_, line);
    return true;
  }

  /// Reads blocks ahead, except for the first line and for a while after that has failed.
  bool read_blocks() {
    if (in_turn_ > 0) {
      --in_turn_;
      return false;
    }
    const std::uint64_t most = is_counted() ? count_.points - next_ : ~std::uint64_t{0};
    const auto parse = PointLineBlocks::of_lines(
        [line = prologue_.line](std::string_view text, Vec3& point) mutable {
          text = without_leading_blanks(text);
          if (is_text_comment(text)) return PointLineBlocks::Line::kNothing;
          return line.parse(text, point) ? PointLineBlocks::Line::kPoint
                                         : PointLineBlocks::Line::kOther;
        });
    const auto read = blocks_.read(input_, parse, most);
    if (!read) {
      in_turn_ = kBatchPoints;
      return false;
    }
    next_ += *read;
    return true;
  }

  void start() {
    count_ = first_;
    declared_ = first_.points;
    counts_ = 1;
    next_ = 0;
    open_end_ = OpenEnd(prologue_.refuses_cut);
    finished_ = false;
    blocks_.clear();
    in_turn_ = 1;
  }

  [[noreturn]] void fail(const std::string& what, Remedy remedy = Remedy::kNone) const {
    refuse_line(input_.name(), input_.line(), what, remedy);
  }

  std::string as_declared() const { return "line " + std::to_string(count_.line) + " declares"; }

  bool next_point_line(std::string_view& line) {
    while (next_data_line(input_, line)) {
      if (!is_counted() || next_ < count_.points) {
        ++next_;
        return true;
      }
      begin_count(line);
    }
    return false;
  }

  /// Called after all declared points: reads the number of further points.
  void begin_count(std::string_view line) {
    const auto points = count_in(line);
    if (!points) {
      fail("more than the " + std::to_string(count_.points) + " points that " + as_declared());
    }
    count_ = {*points, input_.line()};
    next_ = 0;
    ++counts_;
    check_room();
    declared_ += *points;
    info_.declared_points = std::max(*info_.declared_points, declared_);
  }

  void check_room() const {
    if (count_.points <= most_points_in_rest(input_)) return;
    refuse_line(input_.name(), count_.line,
                "declares " + format_count(count_.points) + " points, for which the file of " +
                    format_count(*input_.size()) + " bytes is too short; expected a line for each");
  }

  [[noreturn]] void refuse_point(std::string_view line) const {
    std::string where = "the coordinates x y z";
    const CoordinateColumns& columns = prologue_.line.columns();
    if (columns != kFirstThree) {
      where = "in columns";
      for (const std::size_t column : columns) where += " " + std::to_string(column + 1);
    }
    std::string after;
    if (is_counted()) {
      after = " after " + std::to_string(next_ - 1) + " of the " + std::to_string(count_.points) +
              " points that " + as_declared();
    }
    const bool first = next_ == 1 && counts_ == 1;
    fail(excerpt(line) + after + decimal_commas_in(line) + "; expected three numbers, " + where +
             ", in blanks, commas or semicolons",
         first && may_choose_ ? Remedy::kColumns : Remedy::kNone);
  }

  void finish() {
    if (finished_) return;
    finished_ = true;
    if (is_counted() && next_ < count_.points) {
      refuse(input_.name(), "ends after line {} with {} points; expected {} as {}", input_.line(),
             next_, count_.points, as_declared());
    }
    open_end_.append_to(info_.remarks, input_.name());
  }

  InputBuffer input_;
  bool may_choose_;
  XyzPrologue prologue_;
  CloudInfo& info_ = prologue_.info;
  std::size_t remarks_at_start_;
  InputBuffer::Mark first_point_;
  Count first_{info_.declared_points.value_or(0), prologue_.count_line};
  Count count_;                 ///< the count whose points are being read
  std::uint64_t declared_ = 0;  ///< sum of all counts up to count_
  std::uint64_t counts_ = 0;    ///< number of counts so far, including count_
  std::uint64_t next_ = 0;      ///< points of count_ read so far
  PointLineBlocks blocks_;
  std::size_t in_turn_ = 1;  ///< number of lines to read one by one before reading ahead
  OpenEnd open_end_;
  bool finished_ = false;
};

}  // namespace

std::unique_ptr<PointReader> read_xyz(InputBuffer input, const PointReadOptions& options,
                                      std::vector<Message> remarks) {
  if (!options.columns.empty() && options.columns.size() != 3) {
    throw UsageError(std::to_string(options.columns.size()) +
                     " columns chosen; expected three, of x, y and z");
  }
  XyzPrologue prologue = read_xyz_prologue(input, options);
  std::vector<Message>& known = prologue.info.remarks;
  known.insert(known.begin(), remarks.begin(), remarks.end());
  return std::make_unique<XyzReader>(std::move(input), std::move(prologue), options.may_choose);
}

std::unique_ptr<PointReader> read_xyz(InputBuffer input, XyzPrologue prologue) {
  return std::make_unique<XyzReader>(std::move(input), std::move(prologue), false);
}

}  // namespace clearway
