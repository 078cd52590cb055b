#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "clearway/clearway.hpp"
#include "support/catch.hpp"

/// What a station table must say, from its definition alone.
namespace clearway::test {

inline std::vector<double> chainages(const std::vector<Pose>& poses) {
  std::vector<double> out{0};
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double* a = poses[i - 1].translation;
    const double* b = poses[i].translation;
    out.push_back(out.back() +
                  std::sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) +
                            (b[2] - a[2]) * (b[2] - a[2])));
  }
  return out;
}

/// The row of each pose, by the definition.
inline std::vector<std::size_t> rows_of(const std::vector<Pose>& poses, double every) {
  const std::vector<double> chainage = chainages(poses);
  const auto rows = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil((chainage.back() - 1e-6) / every)));
  std::vector<std::size_t> out;
  for (const double c : chainage) {
    out.push_back(std::min(static_cast<std::size_t>(std::floor(c / every)), rows - 1));
  }
  return out;
}

/// The second motion, and then the first.
inline Pose times(const Pose& a, const Pose& b) {
  Pose out{};
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        out.rotation[3 * k + j] += a.rotation[3 * k + i] * b.rotation[3 * i + j];
      }
      out.translation[k] += a.rotation[3 * k + j] * b.translation[j];
    }
    out.translation[k] += a.translation[k];
  }
  return out;
}

/// The place of a point in the frame of a pose whose rotation is orthonormal.
inline Vec3 seen_from(const Vec3& p, const Pose& pose) {
  const Vec3 d{p.x - pose.translation[0], p.y - pose.translation[1], p.z - pose.translation[2]};
  const double* r = pose.rotation;
  return {r[0] * d.x + r[3] * d.y + r[6] * d.z, r[1] * d.x + r[4] * d.y + r[7] * d.z,
          r[2] * d.x + r[5] * d.y + r[8] * d.z};
}

inline Box box_around(const std::vector<Vec3>& points) {
  Box out{points[0], points[0]};
  for (const Vec3& p : points) {
    out = {{std::min(out.lo.x, p.x), std::min(out.lo.y, p.y), std::min(out.lo.z, p.z)},
           {std::max(out.hi.x, p.x), std::max(out.hi.y, p.y), std::max(out.hi.z, p.z)}};
  }
  return out;
}

/// The least distance and its source.
using Least = std::optional<std::pair<double, std::uint64_t>>;

struct ExpectedRow {
  Least least, left, right, above;
};

/// Sorts the profile and the clearances of a result into rows by the definition.
inline std::vector<ExpectedRow> expected_rows(const Result& result, const Query& query,
                                              double every) {
  const std::vector<std::size_t> row_of = rows_of(query.poses, every);
  std::vector<ExpectedRow> out(row_of.back() + 1);
  if (query.profile > 0) {
    const Profile profile = result.profile();
    for (std::size_t i = 0; i < profile.size(); ++i) {
      if (profile.source[i] == Profile::kNoPoint) continue;
      Least& least = out[row_of[i]].least;
      const std::pair found(profile.distance[i], profile.source[i]);
      if (!least || found < *least) least = found;
    }
  }
  const Clearances rows = query.clearance > 0 ? result.clearance() : Clearances();
  const auto bodies = moving_bodies(query);
  std::vector<Box> boxes;
  for (const auto& body : bodies) boxes.push_back(box_around(body.model.vertices));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::pair found(rows.distance[i], rows.source[i]);
    const auto keep = [&](Least& least) {
      if (!least || found < *least) least = found;
    };
    const std::uint32_t body = rows.body.empty() ? 0 : rows.body[i];
    const Box& box = boxes[body];
    const Pose* pose = bodies[body].pose_at(rows.pose[i]);
    REQUIRE(pose != nullptr);
    const Vec3 there = seen_from(rows.xyz[i], *pose);
    ExpectedRow& row = out[row_of[rows.pose[i]]];
    keep(row.least);
    if (there.y > box.hi.y) {
      keep(row.left);
    } else if (there.y < box.lo.y) {
      keep(row.right);
    } else if (there.z > box.hi.z) {
      keep(row.above);
    }
  }
  return out;
}

inline void check_place(const std::optional<FoundPlace>& place, const Least& expected) {
  REQUIRE(place.has_value() == expected.has_value());
  if (!place) return;
  CHECK(place->distance == expected->first);
  CHECK(place->source == expected->second);
}

/// Checks the distances of all rows of a table. radius: that of the query.
inline void check_distances(const StationTable& table, const std::vector<ExpectedRow>& expected,
                            double radius) {
  REQUIRE(table.rows.size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CAPTURE(i);
    const bool conflict = table.rows[i].verdict == Verdict::kConflict;
    const bool known = expected[i].least && (!conflict || expected[i].least->first < radius);
    check_place(table.rows[i].least, known ? expected[i].least : std::nullopt);
    CHECK(table.rows[i].least_below == (conflict && !known ? std::optional(radius) : std::nullopt));
    check_place(table.rows[i].left, expected[i].left);
    check_place(table.rows[i].right, expected[i].right);
    check_place(table.rows[i].above, expected[i].above);
  }
}

}  // namespace clearway::test
