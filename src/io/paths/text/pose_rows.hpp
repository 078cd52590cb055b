#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/util/format.hpp"
#include "io/paths/pose_input.hpp"
#include "io/paths/text/trajectory_columns.hpp"
#include "io/paths/trajectory_file.hpp"

namespace clearway {

/// The objection that a line does not have as many numbers as expected. count: nullopt for a line
/// that is not all numbers, one above `most` for more.
Objection objection_to_count(std::string_view line, std::optional<std::size_t> count,
                             std::size_t most, const std::string& expected);

/// The unit of positions that the header names, or else the option; not known where neither does. A
/// header in "ft" does not contradict an option that says which foot it is. texts: the units in the
/// header, in lower case, or empty. name: the file's. Throws InputError where they are not known,
/// differ, exist only for some positions, or contradict the option.
FileUnit unit_of_positions(std::span<const std::string> texts, const FileUnit& option,
                           const std::string& name);

/// Reads lines of text into poses, all in one known format.
class PoseRows {
 public:
  /// columns: for kCsv and kEuroc. name: the file's, for messages.
  PoseRows(TrajectoryFormat format, std::optional<PoseColumns> columns, TrajectoryOptions options,
           std::string name);

  /// Adds the pose of a line. Returns why the line is not a pose; without text where it is one.
  Objection add(std::string_view line);
  /// An empty object for up to `lines` further lines of the file after the first, to be filled and
  /// appended.
  PoseRows for_lines(std::size_t lines) const;
  void append(std::vector<PoseRows> parts);
  /// Moves all poses to `out`. Called after the last line.
  void finish(TrajectoryFile& out);

 private:
  /// Calls `use` with each list of some rows and the same list of others.
  template <typename Rows, typename Use>
  static void each_list(PoseRows& rows, Rows& others, Use use);
  // These throw an Objection to the line.
  void add_matrix(std::string_view line);
  void add_quaternion(std::string_view line);
  void add_columns(std::string_view line);
  void add_angles(const std::array<double, 3>& position);
  void numbers_in(std::span<const std::size_t> columns, std::span<double> out) const;
  void add_labels();
  void add_label(const PoseLabel<double>& label, std::string_view field,
                 const UnitFactor& in_metres);
  void add_label(const PoseLabel<std::string>& label, std::string_view field,
                 const UnitFactor& in_metres);
  void push(const Pose& pose);
  double metres_of(const LabelColumn& column) const;
  bool is_geographic() const { return columns_ && columns_->geographic; }

  TrajectoryFormat format_;
  std::optional<PoseColumns> columns_;
  TrajectoryOptions options_;
  std::string name_;
  FileUnit unit_;      ///< unit of positions
  double metres_ = 0;  ///< metres of that unit; 0 where it is not known
  /// Conversion from that unit to metres; none from the environment's own unit.
  UnitFactor in_metres_{1};
  std::size_t row_numbers_ = 0;  ///< 12 or 16 numbers in every line; 0 before the first line
  std::array<double, 16> numbers_{};
  std::vector<std::string_view> fields_;
  std::vector<Pose> poses_;
  std::vector<AttitudeRow> angles_;
  PoseLabels labels_;
  std::vector<UnitFactor> labels_in_metres_;  ///< for each label, where there are columns
};

}  // namespace clearway
