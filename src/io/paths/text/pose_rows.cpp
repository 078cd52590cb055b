#include "io/paths/text/pose_rows.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <string>
#include <utility>

#include "clearway/file_unit.hpp"
#include "clearway/trajectory.hpp"
#include "core/describe/labels.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_number.hpp"
#include "io/paths/text/trajectory_columns.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/text/point_blocks.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {
namespace {

FileUnit unit_in_header(std::span<const std::string> texts, const std::string& name) {
  const auto declared =
      common_unit<FileUnit>(texts, "positions", file_unit_list(), file_unit_of, name);
  if (!declared) return {};
  const bool all = std::ranges::none_of(texts, &std::string::empty);
  if (declared->metres() != 1 && !all) {
    refuse(name, "the header has a unit for some of the positions; expected one for all or none");
  }
  return *declared;
}

bool contradict(const FileUnit& header, const FileUnit& option) {
  if (!header.is_known() || !option.is_known() || header == option) return false;
  const bool vague = header.is_any_foot() || option.is_any_foot();
  return !(vague && is_foot(header.metres()) && is_foot(option.metres()));
}

}  // namespace

FileUnit unit_of_positions(std::span<const std::string> texts, const FileUnit& option,
                           const std::string& name) {
  const FileUnit declared = unit_in_header(texts, name);
  if (contradict(declared, option)) {
    refuse(name, "the header has positions in units of " + format_digits(declared.metres(), 9) +
                     " m, but a unit of " + format_digits(option.metres(), 9) + " m was declared");
  }
  const bool option_counts = !declared.is_known() || (declared.is_any_foot() && option.is_known());
  return option_counts ? option : declared;
}

namespace {

/// A time in seconds, whose unit follows from its size alone: ns, us, ms or s since 1970.
double seconds_of(double time) {
  constexpr double kNanoseconds = 1e17;
  constexpr double kMicroseconds = 1e14;
  constexpr double kMilliseconds = 1e11;
  const double size = std::abs(time);
  return time * (size >= kNanoseconds    ? 1e-9
                 : size >= kMicroseconds ? 1e-6
                 : size >= kMilliseconds ? 1e-3
                                         : 1);
}

void check(Objection objection) {
  if (!objection.text.empty()) throw objection;
}

/// The name in a field, without blanks and quotes around it.
std::string name_of_pose(std::string_view field) {
  constexpr std::string_view kAround = " \t\"'";
  if (field.find("\"\"") != std::string_view::npos) return unquoted(field);
  const std::size_t first = std::min(field.find_first_not_of(kAround), field.size());
  return std::string(field.substr(first, field.find_last_not_of(kAround) + 1 - first));
}

}  // namespace

Objection objection_to_count(std::string_view line, std::optional<std::size_t> count,
                             std::size_t most, const std::string& expected) {
  if (const std::string commas = decimal_commas_in(line); !commas.empty()) {
    return {excerpt(line) + commas + ", as in 0.25"};
  }
  if (!count) return {excerpt(line) + "; expected numbers only, in blanks or commas: " + expected};
  const std::string found =
      *count > most ? "more than " + std::to_string(most) : std::to_string(*count);
  switch (*count) {
    case 3:
    case 4:
      return {found +
              " numbers; a matrix spread over several lines is not read. Expected each "
              "pose on one line: " +
              expected};
    case 6:
      return {
          "6 numbers; for a position and three angles, expected a header before them, for "
          "example: x y z roll_deg pitch_deg heading_deg"};
    case 7:
      return {
          "7 numbers; for a position and a quaternion, the order of the quaternion is to be "
          "named: the format is pose-xyzw (w last) or pose-wxyz (w first)",
          Remedy::kNameFormat};
    default:
      return {found + " numbers; expected " + expected};
  }
}

PoseRows::PoseRows(TrajectoryFormat format, std::optional<PoseColumns> columns,
                   TrajectoryOptions options, std::string name)
    : format_(format),
      columns_(std::move(columns)),
      options_(std::move(options)),
      name_(std::move(name)) {
  std::span<const std::string> units;
  if (columns_) units = columns_->position_units;
  if (is_geographic()) units = units.subspan(2);
  unit_ = unit_of_positions(units, options_.metres_per_unit, name_);
  metres_ = unit_.metres_in(options_.environment_unit);
  // Numbers in the environment's own unit are kept here and in convert_positions(), because they
  // would change if converted into metres and back.
  const bool stays = metres_ == options_.environment_unit && !is_geographic();
  if (unit_.is_known() && !stays) in_metres_ = UnitFactor(metres_);
  if (!columns_) return;
  for (const LabelColumn& column : columns_->labels) {
    labels_in_metres_.emplace_back(metres_of(column));
  }
}

/// Metres of the unit of a label that is a length: that of its own header, of the positions, or of
/// the environment.
double PoseRows::metres_of(const LabelColumn& column) const {
  const auto named = file_unit_of(column.unit);
  if (named) return named->metres_in(options_.environment_unit);
  return unit_.is_known() ? metres_ : options_.environment_unit;
}

Objection PoseRows::add(std::string_view line) {
  try {
    if (format_ == TrajectoryFormat::kMatrix) {
      add_matrix(line);
    } else if (columns_) {
      add_columns(line);
    } else {
      add_quaternion(line);
    }
    return {};
  } catch (Objection& objection) {
    return std::move(objection);
  }
}

template <typename Rows, typename Use>
void PoseRows::each_list(PoseRows& rows, Rows& others, Use use) {
  use(rows.poses_, others.poses_);
  use(rows.angles_, others.angles_);
  for_each_label([&](const auto& label) { use(label.of(rows.labels_), label.of(others.labels_)); });
}

PoseRows PoseRows::for_lines(std::size_t lines) const {
  PoseRows part(format_, columns_, options_, name_);
  part.row_numbers_ = row_numbers_;
  each_list(part, *this, [lines](auto& list, const auto& first) {
    if (!first.empty()) list.reserve(lines);
  });
  return part;
}

void PoseRows::append(std::vector<PoseRows> parts) {
  std::size_t all = 1;
  for (const PoseRows& part : parts) all += part.poses_.size() + part.angles_.size();
  each_list(*this, *this, [all](auto& list, const auto&) {
    if (!list.empty()) list.reserve(all);
  });
  for (PoseRows& part : parts) {
    each_list(*this, part, [](auto& list, auto& more) {
      list.insert(list.end(), std::make_move_iterator(more.begin()),
                  std::make_move_iterator(more.end()));
      more = {};
    });
  }
}

void PoseRows::push(const Pose& pose) {
  poses_.push_back(pose);
  for (double& coordinate : poses_.back().translation) coordinate = in_metres_(coordinate);
}

void PoseRows::add_matrix(std::string_view line) {
  const auto count = parse_number_line(line, numbers_);
  if (count != 12u && count != 16u) {
    throw objection_to_count(line, count, numbers_.size(), "12 or 16, a row-major matrix");
  }
  if (row_numbers_ == 0) row_numbers_ = *count;
  if (count != row_numbers_) {
    throw Objection{std::to_string(*count) + " numbers; expected " + std::to_string(row_numbers_) +
                    " as in the first line"};
  }
  Pose pose{};
  check(pose_of_matrix(std::span(numbers_).first(*count), options_.allow_non_rigid, pose));
  push(pose);
}

void PoseRows::add_quaternion(std::string_view line) {
  const auto count = parse_number_line(line, numbers_);
  const bool tum = format_ == TrajectoryFormat::kTum;
  const bool w_first = format_ == TrajectoryFormat::kPoseWxyz;
  if (count != (tum ? 8u : 7u)) {
    throw Objection{count ? (*count > numbers_.size() ? "more than 16" : std::to_string(*count)) +
                                " numbers; expected " +
                                (tum       ? "8: t x y z qx qy qz qw"
                                 : w_first ? "7: x y z qw qx qy qz"
                                           : "7: x y z qx qy qz qw")
                          : objection_to_count(line, count, numbers_.size(), "a pose").text};
  }
  if (tum && !std::isfinite(numbers_[0])) throw Objection{"expected a finite time"};
  const auto numbers = std::span<const double>(numbers_).subspan(tum ? 1 : 0, 7);
  std::array<double, 4> quaternion{numbers[3], numbers[4], numbers[5], numbers[6]};
  if (w_first) quaternion = {numbers[4], numbers[5], numbers[6], numbers[3]};
  Pose pose{};
  check(pose_of_quaternion(numbers.first<3>(), quaternion, pose));
  if (tum) labels_.time.push_back(seconds_of(numbers_[0]));
  push(pose);
}

void PoseRows::add_columns(std::string_view line) {
  split_fields(line, columns_->separator, fields_);
  if (fields_.size() != columns_->fields) {
    throw Objection{objection_to_fields(line, fields_.size(), columns_->fields)};
  }
  std::array<double, 3> position{};
  numbers_in(columns_->position, position);
  if (columns_->rotation.size() == 3) return add_angles(position);
  std::array<double, 9> rotation{};
  const auto found = std::span(rotation).first(columns_->rotation.size());
  numbers_in(columns_->rotation, found);
  Pose pose{};
  if (found.size() == 4) {
    check(pose_of_quaternion(position, std::span<const double>(found).first<4>(), pose));
  } else {
    std::array<double, 12> matrix{};
    for (std::size_t k = 0; k < 9; ++k) matrix[4 * (k / 3) + k % 3] = rotation[k];
    for (std::size_t k = 0; k < 3; ++k) matrix[4 * k + 3] = position[k];
    check(pose_of_matrix(matrix, options_.allow_non_rigid, pose));
  }
  add_labels();
  push(pose);
}

void PoseRows::add_angles(const std::array<double, 3>& position) {
  std::array<double, 3> angles{};
  numbers_in(columns_->rotation, angles);
  const double sum = position[0] + position[1] + position[2] + angles[0] + angles[1] + angles[2];
  if (!std::isfinite(sum)) throw Objection{"expected finite numbers"};
  const UnitFactor horizontal = is_geographic() ? UnitFactor(1) : in_metres_;
  angles_.push_back({{horizontal(position[0]), horizontal(position[1]), in_metres_(position[2])},
                     angles[0],
                     angles[1],
                     angles[2]});
  add_labels();
}

void PoseRows::add_labels() {
  std::size_t next = 0;
  for_each_label([&](const auto& label) {
    const std::size_t i = next++;
    if (const auto at = columns_->labels[i].at)
      add_label(label, fields_[*at], labels_in_metres_[i]);
  });
}

void PoseRows::add_label(const PoseLabel<double>& label, std::string_view field,
                         const UnitFactor& in_metres) {
  const auto number = parse_whole_number(field);
  if (!number || !std::isfinite(*number)) return;
  label.of(labels_).push_back(label.unit == FieldUnit::kMetres    ? in_metres(*number)
                              : label.unit == FieldUnit::kSeconds ? seconds_of(*number)
                                                                  : *number);
}

void PoseRows::add_label(const PoseLabel<std::string>& label, std::string_view field,
                         const UnitFactor&) {
  label.of(labels_).push_back(name_of_pose(field));
}

void PoseRows::numbers_in(std::span<const std::size_t> columns, std::span<double> out) const {
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto value = parse_whole_number(fields_[columns[k]]);
    if (!value) throw Objection{objection_to_number(fields_[columns[k]], columns[k], "a number")};
    out[k] = *value;
  }
}

void PoseRows::finish(TrajectoryFile& out) {
  out.format = format_;
  out.poses = std::move(poses_);
  const bool quaternions =
      columns_ ? columns_->rotation.size() == 4 : format_ != TrajectoryFormat::kMatrix;
  if (quaternions) out.rotations = RotationSource::kQuaternions;
  const bool angles = columns_ && columns_->rotation.size() == 3;
  if (angles) append_poses_of_angles(std::move(angles_), *columns_, options_, name_, out);
  for_each_label([&](const auto& label) {
    if (label.of(labels_).size() == out.poses.size()) {
      label.of(out.labels) = std::move(label.of(labels_));
    }
  });
  out.unit = unit_;
  if (metres_ == 0) return;
  // Places on a map are in the map's unit already; the file's unit was that of heights.
  out.in_metres = metres_ != options_.environment_unit && !is_geographic();
  const bool is_metres = metres_ == 1;
  if (is_metres && (options_.environment_unit == 1 || is_geographic())) return;
  std::string what;
  if (is_geographic()) {
    what = "heights were multiplied by " + format_digits(metres_, 9) + " to give metres";
  } else if (metres_ == options_.environment_unit) {
    out.metres_per_unit = metres_;
    what = "positions are in " + units_text(metres_) +
           ", as the environment is, and are taken as they are";
  } else if (options_.environment_unit == 1) {
    what = "positions were multiplied by " + format_digits(metres_, 9) + " to give metres";
  } else {
    what = "positions are in " + units_text(metres_) + " and were converted to " +
           units_text(options_.environment_unit) + ", the unit of the environment";
  }
  out.note("trajectory-unit", name_ + ": " + what, {{"metres", metres_}});
}

}  // namespace clearway
