#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/util/unit_factor.hpp"
#include "io/trajectory/attitude.hpp"
#include "io/trajectory/pose_input.hpp"
#include "io/trajectory/text/trajectory_columns.hpp"
#include "io/trajectory/trajectory_file.hpp"

namespace clearway {

/// How many numbers a line has instead of those expected. count: none for a line that is not all
/// numbers, one above `most` for more.
Objection objection_to_count(std::string_view line, std::optional<std::size_t> count,
                             std::size_t most, const std::string& expected);

/// Reads lines of text into poses, all in one format that is known.
class PoseRows {
 public:
  /// columns: of kCsv and kEuroc. name: of the file, for messages.
  PoseRows(TrajectoryFormat format, std::optional<PoseColumns> columns, TrajectoryOptions options,
           std::string name);

  /// Why the line is no pose; without text where it is one.
  Objection add(std::string_view line);
  /// For up to `lines` other lines of the file, behind the first; to be appended.
  PoseRows for_lines(std::size_t lines) const;
  void append(std::vector<PoseRows> parts);
  /// After the last line.
  void finish(TrajectoryFile& out);

 private:
  Objection add_matrix(std::string_view line);
  Objection add_quaternion(std::string_view line);
  Objection add_columns(std::string_view line);
  Objection add_angles(const std::array<double, 3>& position);
  Objection numbers_in(std::span<const std::size_t> columns, std::span<double> out) const;
  void add_time(double time) { times_.push_back(time); }
  void add_labels();
  void push(const Pose& pose);
  bool is_geographic() const { return columns_ && columns_->geographic; }

  TrajectoryFormat format_;
  std::optional<PoseColumns> columns_;
  TrajectoryOptions options_;
  std::string name_;
  FileUnit unit_;                ///< of positions
  double metres_ = 0;            ///< of that unit; 0 where it is not known
  UnitFactor in_metres_{1};      ///< from that unit; from the environment's unit into itself
  std::size_t row_numbers_ = 0;  ///< 12 or 16 in every line; 0: none yet
  std::array<double, 16> numbers_{};
  std::vector<std::string_view> fields_;
  std::vector<Pose> poses_;
  std::vector<AttitudeRow> angles_;
  std::vector<double> times_;
  std::vector<std::string> names_;
};

}  // namespace clearway
