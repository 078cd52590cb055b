#include "support/result_fixture.hpp"

#include <algorithm>
#include <limits>

namespace clearway::test {

ResultHeader sample_header(bool first_pose) {
  ResultHeader header;
  header.environment_points = 5'000'000'000;
  header.environment_hash = 0xfedcba9876543210;
  header.model_points = 1234;
  header.model_hash = 0x0123456789abcdef;
  header.poses = 4'000'000'000;
  header.trajectory_hash = 0xffffffffffffffff;
  header.radius = 0.1;
  header.first_pose = first_pose;
  header.model_box = {{-1.5, -0.75, 0}, {2, 0.75, 3.25}};
  header.quantisation = {{0.001, 0.0001, 0.01}, {5e6, -2e6 + 0.5, 1e3}};
  return header;
}

Collisions sample_rows(const ResultHeader& header, std::size_t count) {
  Collisions rows;
  for (std::size_t i = 0; i < count; ++i) {
    const auto q = static_cast<std::int32_t>(i * 2654435761u);
    rows.source.push_back(3 * i + i % 3 + (i > count / 2 ? 4'000'000'000 : 0));
    rows.xyz.push_back(position(header.quantisation, q, -(q / 2), q ^ 0x55555555));
    if (header.first_pose)
      rows.first_pose.push_back(static_cast<std::uint32_t>(i * 4050343 % header.poses));
    if (header.has_classes()) rows.point_class.push_back(static_cast<std::uint8_t>(i * 7));
  }
  rows.last_pose = rows.first_pose;
  return rows;
}

void add_sample_depths(ResultHeader& header, Collisions& rows) {
  header.depth = true;
  for (std::size_t i = 0; i < rows.source.size(); ++i) {
    const bool is_free = i % 3 != 2;
    rows.depth.push_back(is_free ? 0.125 + static_cast<double>(i) / 7
                                 : std::numeric_limits<double>::quiet_NaN());
    rows.depth_source.push_back(is_free ? header.environment_points - 1 - i : Collisions::kNoPoint);
  }
}

Clearances sample_clearances(const ResultHeader& header, std::size_t count) {
  Clearances rows;
  for (std::size_t i = 0; i < count; ++i) {
    const auto q = static_cast<std::int32_t>(i * 40503u);
    rows.source.push_back(2 * i + 1);
    rows.xyz.push_back(position(header.quantisation, -q, q / 3, 7 - q));
    rows.distance.push_back(header.clearance / static_cast<double>(1 + i % 7));
    rows.pose.push_back(static_cast<std::uint32_t>(i * 4050343 % header.poses));
  }
  return rows;
}

ProfileRows sample_profile(const ResultHeader& header) {
  ProfileRows rows;
  for (std::size_t i = 0; i < header.poses; ++i) {
    const auto q = static_cast<std::int32_t>(i * 40503u);
    const double none = std::numeric_limits<double>::quiet_NaN();
    const bool found = i % 5 != 4;
    rows.distance.push_back(found ? header.profile / static_cast<double>(1 + i % 7)
                                  : std::numeric_limits<double>::infinity());
    rows.source.push_back(found ? i * 4050343 % header.environment_points : Profile::kNoPoint);
    rows.xyz.push_back(found ? position(header.quantisation, q, -q, q / 2)
                             : Vec3{none, none, none});
    rows.chainage.push_back(0.25 * static_cast<double>(i / 2));
  }
  return rows;
}

namespace {

template <typename Rows>
void append_in_steps(ResultWriter& writer, const ResultHeader& header, const Rows& rows,
                     std::size_t step) {
  for (std::size_t from = 0; from < rows.size(); from += step) {
    Rows part = part_of(rows, from, std::min(step, rows.size() - from));
    if constexpr (std::is_same_v<Rows, Collisions>) {
      if (!header.first_pose) part.first_pose.clear();
      if (part.last_pose.size() != part.first_pose.size()) part.last_pose = part.first_pose;
    }
    writer.append(part);
  }
}

}  // namespace

void write_result(const std::filesystem::path& path, const ResultHeader& header,
                  const Collisions& rows, std::size_t step, const Clearances& clearances,
                  const ProfileRows& profile) {
  ResultWriter writer(path, header, rows.size(), clearances.size());
  append_in_steps(writer, header, rows, step);
  append_in_steps(writer, header, clearances, step);
  append_in_steps(writer, header, profile, step);
  ResultFindings findings;
  if (header.floor) findings.floor_colliding = 0;
  writer.finish(findings);
}

}  // namespace clearway::test
