#include "io/result/tables.hpp"

#include <cmath>

#include "clearway/error.hpp"

namespace clearway {
namespace {

bool is_finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

bool is_absent(const Vec3& p) { return std::isnan(p.x) && std::isnan(p.y) && std::isnan(p.z); }

/// Whether the number can be a distance in metres: 0 or more, or any finite number where the model
/// has solids.
bool is_distance(const ResultHeader& header, double distance) {
  return distance >= 0 || (header.model_solids > 0 && distance < 0 && std::isfinite(distance));
}

}  // namespace

void RowsRead::refuse_row(const char* dataset, std::size_t row, const std::string& expected) const {
  throw InputError(name + ": /" + group + "/" + dataset + ", row " + std::to_string(first + row) +
                   ": expected " + expected);
}

void check_sources(const RowsRead& read, const char* dataset,
                   std::span<const std::uint64_t> source) {
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (source[i] < read.header.environment_points) continue;
    read.refuse_row(dataset, i, "an index below environment_points");
  }
}

void check_points(const RowsRead& read, const char* dataset, std::span<const Vec3> xyz) {
  for (std::size_t i = 0; i < xyz.size(); ++i) {
    if (!is_finite(xyz[i])) read.refuse_row(dataset, i, "finite coordinates");
  }
}

void check_poses(const RowsRead& read, const char* dataset, std::span<const std::uint32_t> pose) {
  for (std::size_t i = 0; i < pose.size(); ++i) {
    if (pose[i] >= read.header.poses) read.refuse_row(dataset, i, "a pose below poses");
  }
}

void check_bodies(const RowsRead& read, const char* dataset, std::span<const std::uint32_t> body) {
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (body[i] >= read.header.bodies.size()) read.refuse_row(dataset, i, "one of the bodies");
  }
}

void check_flags(const RowsRead& read, const char* dataset, std::span<const std::uint8_t> flags) {
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (flags[i] > 1) read.refuse_row(dataset, i, "0 or 1");
  }
}

void check_clearances(const RowsRead& read, const char* dataset, std::span<const double> distance) {
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (!(is_distance(read.header, distance[i]) && distance[i] <= read.header.clearance)) {
      read.refuse_row(dataset, i, "a distance from 0 to the clearance");
    }
  }
}

void check_chainages(const RowsRead& read, const char* dataset, std::span<const double> chainage) {
  for (std::size_t i = 0; i < chainage.size(); ++i) {
    if (read.first == 0 && i == 0 && chainage[i] != 0) read.refuse_row(dataset, i, "0");
    if (!(chainage[i] >= 0)) read.refuse_row(dataset, i, "metres, 0 or above");
  }
}

void Table<Collisions>::check(const RowsRead& read, const Collisions& rows) {
  for (std::size_t i = 0; i < rows.last_pose.size(); ++i) {
    if (rows.last_pose[i] >= rows.first_pose[i]) continue;
    read.refuse_row("last_pose", i, "a pose that is not before the first one");
  }
  for (std::size_t i = 0; i < rows.depth.size(); ++i) {
    const bool is_free = rows.depth_source[i] != Collisions::kNoPoint;
    if (is_free && rows.depth_source[i] >= read.header.environment_points) {
      read.refuse_row("depth_source", i, "an index below environment_points, or 2^64 - 1 for none");
    }
    if (is_free ? !(rows.depth[i] >= 0) : !std::isnan(rows.depth[i])) {
      read.refuse_row("depth", i,
                      is_free ? "a distance, 0 or more"
                              : "no number (NaN), as no point of the environment is free");
    }
  }
}

void Table<ProfileRows>::check(const RowsRead& read, const ProfileRows& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.source[i] == Profile::kNoPoint) {
      if (!(std::isinf(rows.distance[i]) && rows.distance[i] > 0)) {
        read.refuse_row("distance", i, "infinity, as the pose has no point");
      }
      if (!is_absent(rows.xyz[i])) {
        read.refuse_row("xyz", i, "no numbers (NaN), as the pose has no point");
      }
      continue;
    }
    if (rows.source[i] >= read.header.environment_points) {
      read.refuse_row("source", i, "an index below environment_points, or 2^64 - 1 for none");
    }
    // The root of a number below fl(D D) may round to D, so D itself is valid.
    if (!(is_distance(read.header, rows.distance[i]) && rows.distance[i] <= read.header.profile)) {
      read.refuse_row("distance", i, "a distance from 0 to the profile's");
    }
    if (!is_finite(rows.xyz[i])) read.refuse_row("xyz", i, "finite coordinates");
  }
}

void check_steps(const RowsRead& read, const char* dataset, std::span<const double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i]) && values[i] >= 0) continue;
    read.refuse_row(dataset, i, "a finite length, 0 or above");
  }
}

void check_groups(const RowsRead& read, const char* dataset,
                  std::span<const std::uint32_t> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if ((values[i] == 0) == read.header.part.has_value()) continue;
    read.refuse_row(dataset, i, read.header.part ? "0 in a part" : "a group from 1 on");
  }
}

void check_cells(const RowsRead& read, const char* dataset,
                 std::span<const std::array<std::int32_t, 3>> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i][0] < 0 || values[i][0] > 2) read.refuse_row(dataset, i, "an axis from 0 to 2");
  }
}

void check_parts(const RowsRead& read, const char* dataset, std::span<const std::uint64_t> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] == 0) read.refuse_row(dataset, i, "1 part of a cube or more");
  }
}

}  // namespace clearway
