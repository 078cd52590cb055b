#include "io/paths/text/text_trajectory.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "clearway/answer.hpp"
#include "io/files/input_error.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/text_lines.hpp"
#include "io/files/text_number.hpp"
#include "io/files/thread_limit.hpp"
#include "io/paths/text/pose_rows.hpp"
#include "io/paths/unread_columns.hpp"
#include "io/scans/text/point_blocks.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {
namespace {

class TextTrajectory {
 public:
  TextTrajectory(InputBuffer input, const TrajectoryOptions& options)
      : table_(std::move(input)), options_(options), format_(options.format) {}

  void read(TrajectoryFile& out) {
    while (table_.next()) {
      if (table_.is_comment()) {
        note_comment(table_.line(), out);
      } else if (!rows_ && !started_ && is_header()) {
        started_ = true;
      } else {
        const bool first = !rows_;
        if (first) start(table_.line());
        const Objection objection = rows_->add(table_.line());
        if (!objection.text.empty()) fail(objection);
        if (first && table_.input().can_seek() && read_blocks()) break;
      }
    }
    out.format = format_;
    if (rows_) rows_->finish(out);
    out.labels.made_by = std::move(made_by_);
    remark_unread_columns(table_.name(), unread_, PathTable::kPoses, out);
    if (rows_) table_.remark_cut(out.remarks);
  }

 private:
  [[noreturn]] void fail(const Objection& objection) const {
    table_.refuse_here(objection.text, objection.remedy);
  }

  void note_comment(std::string_view line, TrajectoryFile& out) {
    if (line.starts_with(kMadeByComment)) {
      made_by_ = line.substr(kMadeByComment.size());
    } else if (line.starts_with(kDoubtComment)) {
      note_doubt(line.substr(kDoubtComment.size()), out);
    } else if (!rows_ && reads_names()) {
      if (auto columns = pose_columns(table_.take_header())) columns_ = std::move(columns);
    }
  }

  /// Takes a warning about what the path was made of, as "CODE: TEXT", one of each code.
  static void note_doubt(std::string_view comment, TrajectoryFile& out) {
    const std::size_t colon = comment.find(": ");
    const std::string code(comment.substr(0, colon));
    const bool known = std::ranges::find(out.remarks, code, &Message::code) != out.remarks.end();
    if (colon == std::string_view::npos || !is_doubt(code) || known) return;
    out.remarks.push_back(
        {Message::Severity::kWarning, code, std::string(comment.substr(colon + 2))});
  }

  /// Reads all lines after the first pose in parallel. Returns false, with nothing read, where one
  /// is refused or may be cut; reading them one after the other then finds its number.
  bool read_blocks() {
    const LineBlocks blocks(table_.input());
    if (blocks.count() < 2) return false;
    std::vector<PoseRows> parts(blocks.count(), rows_->for_lines(0));
    std::atomic<bool> good = true;
    tbb::enumerable_thread_specific<std::vector<char>> rooms;
    const auto read_one = [&](std::size_t i) {
      if (!good) return;
      const std::string_view block = blocks.read(i, rooms.local());
      const auto lines = count_line_breaks(block) + 1;
      PoseRows part = rows_->for_lines(lines);
      if (!add_lines(block, part)) good = false;
      parts[i] = std::move(part);
    };
    in_all_threads([&] { for_each_parallel(parts.size(), read_one); });
    if (good) rows_->append(std::move(parts));
    return good;
  }

  static bool add_lines(std::string_view block, PoseRows& rows) {
    std::string_view last;
    const bool good = each_line(block, [&](std::string_view line) {
      last = line = without_leading_blanks(line);
      return is_text_comment(line) || rows.add(line).text.empty();
    });
    return good && (is_line_end(block.back()) || !last.ends_with('.'));
  }

  bool reads_names() const {
    return format_ == TrajectoryFormat::kAuto || format_ == TrajectoryFormat::kCsv;
  }

  /// Whether the first line that is not a comment names columns. Throws where these make no pose.
  bool is_header() {
    if (table_.starts_with_number()) return false;
    if (format_ == TrajectoryFormat::kEuroc) return true;
    if (!reads_names()) return false;
    const std::string_view line = table_.line();
    const TableHeader& names = table_.take_header();
    columns_ = pose_columns(names);
    if (!columns_ && line.starts_with('<')) {
      fail({excerpt(line) +
            " is XML, which is no trajectory; clearway trajectory alignment makes one of LandXML"});
    }
    if (!columns_ && line.starts_with('{')) {
      fail({excerpt(line) +
            " is JSON, which is no trajectory; clearway trajectory line makes one of a line in "
            "GeoJSON"});
    }
    if (!columns_) {
      fail({excerpt(line) + ": " + objection_to_header(names)});
    }
    format_ = TrajectoryFormat::kCsv;
    return true;
  }

  /// Determines the format by the first line of numbers.
  void start(std::string_view line) {
    std::vector<std::string_view> fields;
    split_fields(line, columns_ ? columns_->separator : ',', fields);
    if (format_ == TrajectoryFormat::kEuroc) {
      if (fields.size() < 8) {
        fail({std::to_string(fields.size()) +
              " columns; expected at least 8 with commas: time, position x y z, quaternion w x y "
              "z"});
      }
      columns_ = euroc_columns(fields.size());
    } else if (format_ == TrajectoryFormat::kCsv && !columns_) {
      fail({"expected a header that names the columns before the first numbers"});
    } else if (format_ == TrajectoryFormat::kAuto) {
      if (columns_ && columns_->fields == fields.size()) {
        format_ = TrajectoryFormat::kCsv;
      } else {
        columns_.reset();
        guess(line);
      }
    }
    if (columns_) unread_ = columns_->unread;
    rows_.emplace(format_, std::move(columns_), options_, table_.name());
  }

  /// Guesses the format by the number of numbers, where there is no header.
  void guess(std::string_view line) {
    std::array<double, 16> numbers{};
    const auto count = parse_number_line(line, numbers);
    if (count == 12u || count == 16u) {
      format_ = TrajectoryFormat::kMatrix;
      return;
    }
    if (count != 8u) {
      fail(objection_to_count(
          line, count, numbers.size(),
          "12 or 16 (a matrix), 8 (TUM: t x y z qx qy qz qw), or a header that names the columns. "
          "EuRoC without a header has to be named"));
    }
    constexpr double kSurelyNanoseconds = 1e14;
    if (numbers[0] >= kSurelyNanoseconds) {
      fail(
          {"8 numbers with a time in nanoseconds, but no header; the format can be tum (qx qy qz "
           "qw) or euroc (qw qx qy qz)",
           Remedy::kNameFormat});
    }
    format_ = TrajectoryFormat::kTum;
  }

  TextTable table_;
  TrajectoryOptions options_;
  TrajectoryFormat format_;             ///< kAuto before the first line of numbers
  std::optional<PoseColumns> columns_;  ///< columns that a header or a comment has named
  std::string made_by_;                 ///< see PoseLabels
  std::vector<std::string> unread_;     ///< names of the columns that are not read
  bool started_ = false;                ///< whether a header has been read
  std::optional<PoseRows> rows_;        ///< exists from the first line of numbers on
};

}  // namespace

void read_text_trajectory(InputBuffer input, const TrajectoryOptions& options,
                          TrajectoryFile& out) {
  TextTrajectory(std::move(input), options).read(out);
}

}  // namespace clearway
