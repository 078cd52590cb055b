#include "io/trajectory/trajectory_columns.hpp"

#include <span>
#include <utility>

namespace clearway {
namespace {

constexpr std::string_view kPosition[] = {"",
                                          "t",
                                          "t_",
                                          "p",
                                          "p_",
                                          "pos",
                                          "pos_",
                                          "position_",
                                          "position.",
                                          "pose.position.",
                                          "p_rs_r_",
                                          "translation_",
                                          "translation.",
                                          "field.pose.position.",
                                          "field.pose.pose.position."};
constexpr std::string_view kQuaternion[] = {"q",
                                            "q_",
                                            "quat_",
                                            "quaternion_",
                                            "orientation_",
                                            "orientation.",
                                            "rotation_",
                                            "rotation.",
                                            "pose.orientation.",
                                            "q_rs_",
                                            "field.pose.orientation.",
                                            "field.pose.pose.orientation."};
constexpr std::string_view kMatrix[] = {"r", "r_"};

/// The columns with the suffixes in turn; empty where one is missing or not the only one.
std::vector<std::size_t> find_all(const ColumnNames& header,
                                  std::span<const std::string_view> prefixes,
                                  std::span<const std::string_view> suffixes) {
  std::vector<std::size_t> found;
  for (const std::string_view suffix : suffixes) {
    const auto column = header.find(prefixes, suffix);
    if (!column) return {};
    found.push_back(*column);
  }
  return found;
}

std::vector<std::size_t> find_rotation(const ColumnNames& header) {
  static constexpr std::string_view kXyzw[] = {"x", "y", "z", "w"};
  static constexpr std::string_view kFromZero[] = {"00", "01", "02", "10", "11",
                                                   "12", "20", "21", "22"};
  static constexpr std::string_view kFromOne[] = {"11", "12", "13", "21", "22",
                                                  "23", "31", "32", "33"};
  auto found = find_all(header, kQuaternion, kXyzw);
  if (found.empty()) found = find_all(header, kMatrix, kFromZero);
  if (found.empty()) found = find_all(header, kMatrix, kFromOne);
  return found;
}

}  // namespace

std::optional<PoseColumns> pose_columns(const ColumnNames& header) {
  static constexpr std::string_view kXyz[] = {"x", "y", "z"};
  const auto position = find_all(header, kPosition, kXyz);
  auto rotation = find_rotation(header);
  if (position.empty() || rotation.empty()) return std::nullopt;
  return PoseColumns{header.separator,
                     header.names.size(),
                     {position[0], position[1], position[2]},
                     std::move(rotation)};
}

PoseColumns euroc_columns(std::size_t fields) { return {',', fields, {1, 2, 3}, {5, 6, 7, 4}}; }

}  // namespace clearway
