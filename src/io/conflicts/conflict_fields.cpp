#include "io/conflicts/conflict_fields.hpp"

#include <cmath>
#include <optional>

namespace clearway {
namespace {

template <typename Value, typename Number>
FieldValue value_of(const std::optional<Number>& number) {
  return number ? FieldValue(static_cast<Value>(*number)) : FieldValue();
}

}  // namespace

std::vector<ConflictField> fields_of(const Conflict& c, const ResultHeader& header) {
  std::vector<ConflictField> fields{{"id", std::uint64_t{c.id}},
                                    {"points", c.points},
                                    {"source", c.source},
                                    {"lo_x", c.box.lo.x},
                                    {"lo_y", c.box.lo.y},
                                    {"lo_z", c.box.lo.z},
                                    {"hi_x", c.box.hi.x},
                                    {"hi_y", c.box.hi.y},
                                    {"hi_z", c.box.hi.z},
                                    {"centroid_x", c.centroid.x},
                                    {"centroid_y", c.centroid.y},
                                    {"centroid_z", c.centroid.z},
                                    {"first_pose", std::uint64_t{c.first_pose}},
                                    {"last_pose", std::uint64_t{c.last_pose}},
                                    {"chainage_from", c.chainage_from},
                                    {"chainage_to", c.chainage_to},
                                    {"least_distance", value_of<double>(c.least_distance)},
                                    {"nearest_pose", value_of<std::uint64_t>(c.nearest_pose)},
                                    {"nearest_source", value_of<std::uint64_t>(c.nearest_source)},
                                    {"encroachment", value_of<double>(c.encroachment)},
                                    {"side", std::string_view(name_of(c.side))},
                                    {"lateral", value_of<double>(c.lateral)},
                                    {"height", value_of<double>(c.height)},
                                    {"group", c.group},
                                    {"depth", value_of<double>(c.depth)},
                                    {"points_inside", value_of<std::uint64_t>(c.points_inside)},
                                    {"obstacle_chainage", value_of<double>(c.obstacle_chainage)},
                                    {"shift_left", value_of<double>(c.shift_left)},
                                    {"shift_right", value_of<double>(c.shift_right)}};
  if (c.body) {
    fields.push_back({"body", std::uint64_t{*c.body}});
    fields.push_back({"body_name", std::string_view(header.bodies.at(*c.body))});
  }
  return fields;
}

std::optional<double> rounded_up(std::optional<double> shift) {
  if (shift) *shift = std::ceil(*shift * 1000) / 1000;
  return shift;
}

Conflict as_conflict(const SmallGroup& group) {
  Conflict out;
  out.points = group.points;
  out.source = out.group = group.source;
  out.box = group.box;
  for (int k = 0; k < 3; ++k) out.centroid[k] = (group.box.lo[k] + group.box.hi[k]) / 2;
  out.first_pose = group.first_pose;
  out.last_pose = group.last_pose;
  out.chainage_from = group.chainage_from;
  out.chainage_to = group.chainage_to;
  return out;
}

std::vector<Conflict> small_groups_instead(const Conflicts& conflicts) {
  std::vector<Conflict> out;
  if (!conflicts.listed.empty()) return out;
  for (const SmallGroup& group : conflicts.small) out.push_back(as_conflict(group));
  return out;
}

std::vector<ConflictField> sample_fields(const ResultHeader& header) {
  Conflict conflict;
  if (!header.bodies.empty()) conflict.body = 0;
  return fields_of(conflict, header);
}

}  // namespace clearway
