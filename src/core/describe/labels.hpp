#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "clearway/trajectory.hpp"
#include "core/describe/field.hpp"
#include "core/util/format.hpp"

namespace clearway {

/// Where a sentence about a pose names a label.
enum class LabelPlace {
  kFirst,          ///< before the other labels, as a name
  kNext,           ///< after a name
  kBesideChainage  ///< beside the chainage, because the label says how far along a line a pose is
};

/// A label of poses: a member of PoseLabels, with all that reads, keeps, writes or shows it needs
/// to know.
template <typename Type>
struct PoseLabel {
  using Value = Type;

  std::vector<Type> PoseLabels::*member;
  const char* key;     ///< name in tables, JSON, pages and Python
  const char* plural;  ///< name in messages, as in "times and names"
  const char* title;   ///< word before its value in sentences; empty: the value stands alone
  const char* doc;     ///< documentation in Python
  /// The names in a table's header, in lower case, of the column that gives it.
  std::span<const std::string_view> columns;
  /// The names of the column that gives it where no column has one of the names above.
  std::span<const std::string_view> other_columns = {};
  /// What a number counts. Lengths are read in the unit of the header and kept in metres; of times
  /// the size says which part of a second they count.
  FieldUnit unit = FieldUnit::kNone;
  /// Whether the terminal shows a number with all its digits and without its unit, because its
  /// scale is known to the file alone. It has two digits after the point otherwise.
  bool has_scale_of_file = false;
  /// Whether pages keep it as the difference to the first pose, because it may be large.
  bool is_counted_from_first = false;
  /// Whether a trajectory that is made of the given one has it, at poses between the given ones
  /// linear in the way.
  bool is_interpolated = false;
  LabelPlace place = LabelPlace::kNext;

  static constexpr bool is_text() { return std::is_same_v<Type, std::string>; }
  const std::vector<Type>& of(const PoseLabels& labels) const { return labels.*member; }
  std::vector<Type>& of(PoseLabels& labels) const { return labels.*member; }
};

inline constexpr std::string_view kColumnsOfTime[] = {"time",     "timestamp", "t",       "gpstime",
                                                      "gps_time", "sec",       "seconds", "stamp"};
inline constexpr std::string_view kColumnsOfName[] = {
    "name", "pose_name", "label", "station", "image", "filename", "file_name", "file", "scan"};
inline constexpr std::string_view kColumnsOfIndex[] = {
    "index", "id", "pose", "pose_id", "pose_index", "pose_nr", "frame", "number", "nr", "seq"};
inline constexpr std::string_view kColumnsOfStation[] = {"station"};

/// The labels of poses, in the order of tables and JSON.
inline constexpr std::tuple kPoseLabels{
    PoseLabel{.member = &PoseLabels::time,
              .key = "time",
              .plural = "times",
              .title = "time",
              .doc = "The time of each pose in seconds, as the file counts them: n float64, or "
                     "empty.",
              .columns = kColumnsOfTime,
              .unit = FieldUnit::kSeconds,
              .has_scale_of_file = true,
              .is_counted_from_first = true},
    PoseLabel{.member = &PoseLabels::name,
              .key = "name",
              .plural = "names",
              .title = "",
              .doc = "The name or index that the file gives each pose: n texts, or empty.",
              .columns = kColumnsOfName,
              .other_columns = kColumnsOfIndex,
              .place = LabelPlace::kFirst},
    PoseLabel{.member = &PoseLabels::station,
              .key = "station",
              .plural = "stations",
              .title = "station",
              .doc = "The station of each pose along its alignment or line, metres: n float64, or "
                     "empty.",
              .columns = kColumnsOfStation,
              .unit = FieldUnit::kMetres,
              .is_interpolated = true,
              .place = LabelPlace::kBesideChainage}};

inline constexpr std::size_t kPoseLabelCount = std::tuple_size_v<decltype(kPoseLabels)>;

/// Calls visit(label) for each label.
template <typename Visit>
void for_each_label(const Visit& visit) {
  for_each_field(kPoseLabels, visit);
}

/// Calls visit(label) for each label that sentences name at one of the places, in their order.
template <typename Visit>
void for_each_label(std::initializer_list<LabelPlace> places, const Visit& visit) {
  for (const LabelPlace place : places) {
    for_each_label([&](const auto& label) {
      if (label.place == place) visit(label);
    });
  }
}

/// Whether any pose has a label.
inline bool has_labels(const PoseLabels& labels) {
  bool found = false;
  for_each_label([&](const auto& label) { found = found || !label.of(labels).empty(); });
  return found;
}

/// The names of the labels that `is_meant` picks, as in "times, names and stations".
template <typename Picks>
std::string names_of_labels(const Picks& is_meant) {
  std::vector<std::string> names;
  for_each_label([&](const auto& label) {
    if (is_meant(label)) names.emplace_back(label.plural);
  });
  return format_list(names);
}

}  // namespace clearway
