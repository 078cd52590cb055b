#include "core/section/section_poses.hpp"

#include <algorithm>
#include <limits>

#include "clearway/error.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/section/section_map.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

constexpr double kMostNumber = 2147483647;  ///< of a column, a row or a bin
/// Between poses, of which few may pass very many bins.
constexpr double kMostBinsOnWays = 1 << 24;

void check_sides(const SectionParameters& asked) {
  if (!(std::isfinite(asked.rear) && std::isfinite(asked.front) && asked.rear <= asked.front)) {
    throw UsageError("a load from x = " + format_number(asked.rear) + " to " +
                     format_number(asked.front) +
                     "; expected its rear, and then its front at no smaller x");
  }
  const SectionWindow& w = *asked.window;
  const bool finite = std::isfinite(w.y_from) && std::isfinite(w.y_to) && std::isfinite(w.z_from) &&
                      std::isfinite(w.z_to);
  if (!(finite && w.y_from < w.y_to && w.z_from < w.z_to)) {
    throw UsageError("a window of the cross-section from y = " + format_number(w.y_from) + " to " +
                     format_number(w.y_to) + " and from z = " + format_number(w.z_from) + " to " +
                     format_number(w.z_to) + " is empty; expected the smaller number first");
  }
  if (!(std::isfinite(asked.cell) && asked.cell > 0 && std::isfinite(asked.bin) && asked.bin > 0 &&
        std::isfinite(asked.margin) && asked.margin >= 0)) {
    throw UsageError("expected cells and bins of a length above 0, and a margin of 0 or more");
  }
}

}  // namespace

SectionLattice section_lattice(const SectionParameters& parameters, double motion) {
  check_sides(parameters);
  const SectionWindow& window = *parameters.window;
  SectionLattice lattice{};
  lattice.x_from = parameters.rear - parameters.margin - motion / 2;
  lattice.x_to = parameters.front + parameters.margin + motion / 2;
  const double g = lattice.cell = parameters.cell;
  lattice.per_cell = 1 / g;
  lattice.j_from = std::floor(window.y_from / g);
  lattice.j_to = std::ceil(window.y_to / g);
  lattice.k_from = std::floor(window.z_from / g);
  lattice.k_to = std::ceil(window.z_to / g);
  const double columns = lattice.j_to - lattice.j_from, rows = lattice.k_to - lattice.k_from;
  for (const double number : {lattice.j_from, lattice.j_to, lattice.k_from, lattice.k_to}) {
    if (!(std::abs(number) <= kMostNumber) || !(columns * rows <= kMostNumber)) {
      throw UsageError("cells of " + format_number(g) +
                       " are too small for the window; expected at most 2^31 cells, with numbers "
                       "of at most 2^31");
    }
  }
  lattice.columns = static_cast<std::uint32_t>(columns);
  lattice.rows = static_cast<std::uint32_t>(rows);
  return lattice;
}

SectionLattice lattice_of(const SectionFacts& section) {
  return section_lattice(section.parameters, section.motion.value_or(std::array<double, 2>{})[0]);
}

SectionMapShape::SectionMapShape(const SectionLattice& lattice) {
  levels = 0;
  entries = 0;
  std::uint32_t across = lattice.columns, up = lattice.rows;
  while (true) {
    columns[levels] = across;
    rows[levels] = up;
    start[levels] = entries;
    entries += std::uint64_t{across} * up;
    ++levels;
    if (across == 1 && up == 1) return;
    across = (across + 3) / 4;
    up = (up + 3) / 4;
  }
}

std::vector<bool> SectionMaps::blocked_anywhere(std::uint64_t bins) const {
  std::vector<bool> anywhere(std::uint64_t{shape_.columns[0]} * shape_.rows[0]);
  for (std::uint64_t bin = 0; bin < bins; ++bin) {
    const std::span of_bin = firsts(bin);
    for (std::size_t cell = 0; cell < of_bin.size(); ++cell) {
      if (of_bin[cell] != kNotBlocked) anywhere[cell] = true;
    }
  }
  return anywhere;
}

SectionBinNumbers bins_of_poses(std::span<const double> chainage, std::size_t first,
                                std::size_t last, const SectionParameters& parameters) {
  double from = chainage[first], to = chainage[last];
  if (parameters.between_poses) {
    if (first > 0) from = (chainage[first - 1] + from) / 2;
    if (last + 1 < chainage.size()) to = (to + chainage[last + 1]) / 2;
  }
  return {std::floor(from / parameters.bin), std::floor(to / parameters.bin)};
}

std::vector<SectionBin> section_bins(std::span<const double> chainage,
                                     std::span<const std::uint32_t> path_pose,
                                     const SectionParameters& parameters) {
  std::vector<SectionBin> bins;
  const auto too_short = [&](const char* most) {
    throw UsageError("bins of " + format_number(parameters.bin) +
                     " are too short for this path; expected at most " + most + " bins");
  };
  const bool ways = parameters.between_poses;
  if (ways && !path_pose.empty()) chainage = chainage.subspan(path_pose[0], path_pose.size());
  for (std::uint32_t i = 0; i < path_pose.size(); ++i) {
    const std::size_t pose = ways ? i : path_pose[i];
    const SectionBinNumbers of = bins_of_poses(chainage, pose, pose, parameters);
    if (!(of.last <= kMostNumber)) too_short("2^31");
    const double more = of.last - of.first;
    if (ways && static_cast<double>(bins.size()) + more > kMostBinsOnWays) too_short("2^24");
    const auto last = static_cast<std::uint64_t>(of.last);
    for (auto number = static_cast<std::uint64_t>(of.first); number <= last; ++number) {
      if (bins.empty() || bins.back().number != number) bins.push_back({number, i, 0});
      ++bins.back().count;
    }
  }
  return bins;
}

SectionPoses::SectionPoses(std::span<const Pose> poses, std::span<const std::uint32_t> path_pose,
                           std::span<const SectionBin> bins)
    : poses_(poses), path_pose_(path_pose), bins_(bins) {
  pull_backs_.reserve(poses.size());
  for (const Pose& pose : poses) pull_backs_.emplace_back(pose);
  add_bins(0, static_cast<std::uint32_t>(bins.size()));
}

std::size_t SectionPoses::open(std::uint32_t first, std::uint32_t count, std::uint32_t bin) {
  SectionPoseNode node{};
  node.first = first;
  node.count = count;
  node.bin = bin;
  node.first_pose = path_pose_[first];
  const std::uint32_t reference = first + count / 2;
  const auto inverse_row = [this](std::uint32_t pose, int axis) {
    const PullBack& of = pull_backs_[pose];
    return (1 / of.determinant) * of.rows[axis];
  };
  for (int k = 0; k < 3; ++k) node.position[k] = poses_[reference].translation[k];
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 own = inverse_row(reference, axis);
    for (int k = 0; k < 3; ++k) node.row[axis][k] = own[k];
    for (std::uint32_t i = first; i < first + count; ++i) {
      const Vec3 row = inverse_row(i, axis);
      for (int k = 0; k < 3; ++k) {
        node.spread[axis][k] = std::max(node.spread[axis][k], std::abs(row[k] - own[k]));
      }
      const double shift = -dot(row, poses_[i].position() - poses_[reference].position());
      node.shift_from[axis] = std::min(node.shift_from[axis], shift);
      node.shift_to[axis] = std::max(node.shift_to[axis], shift);
    }
  }
  add_pace(node);
  nodes_.push_back(node);
  return nodes_.size() - 1;
}

/// Where the load moves on by about as much from each pose to the next, a line shows when a point
/// comes into the range of x'.
void SectionPoses::add_pace(SectionPoseNode& node) const {
  if (node.count < 2) return;
  const Vec3 reference{node.position[0], node.position[1], node.position[2]};
  const auto shift_of = [&](std::uint32_t pose) {
    const PullBack& of = pull_backs_[pose];
    return -dot((1 / of.determinant) * of.rows[0], poses_[pose].position() - reference);
  };
  const std::uint32_t last = node.first + node.count - 1;
  const double way = (shift_of(node.first) - shift_of(last)) / (node.count - 1);  // of a pose
  const double pace = 1 / way;
  if (!std::isfinite(pace)) return;
  node.pace = pace;
  node.pace_shift = shift_of(node.first);
  for (std::uint32_t i = 1; i < node.count; ++i) {
    const double level = shift_of(node.first + i) + way * i;
    node.pace_shift =
        pace > 0 ? std::min(node.pace_shift, level) : std::max(node.pace_shift, level);
  }
}

void SectionPoses::add_bins(std::uint32_t first, std::uint32_t count) {
  if (count == 1) return add_poses(bins_[first].first, bins_[first].count, first);
  const SectionBin& last = bins_[first + count - 1];
  const std::size_t self = open(bins_[first].first, last.first + last.count - bins_[first].first,
                                SectionPoseNode::kManyBins);
  add_bins(first, count / 2);
  nodes_[self].right = static_cast<std::uint32_t>(nodes_.size());
  add_bins(first + count / 2, count - count / 2);
  nodes_[self].end = static_cast<std::uint32_t>(nodes_.size());
}

void SectionPoses::add_poses(std::uint32_t first, std::uint32_t count, std::uint32_t bin) {
  const std::size_t self = open(first, count, bin);
  if (count > kLeafPoses) {
    add_poses(first, count / 2, bin);
    nodes_[self].right = static_cast<std::uint32_t>(nodes_.size());
    add_poses(first + count / 2, count - count / 2, bin);
  }
  nodes_[self].end = static_cast<std::uint32_t>(nodes_.size());
}

double section_rounding(double largest_point, std::span<const Pose> poses,
                        const SectionParameters& parameters, const SectionLattice& lattice) {
  double largest_pose = 1, largest_end = 1;
  for (const Pose& pose : poses) {
    for (const double p : pose.translation) largest_pose = std::max(largest_pose, std::abs(p));
  }
  const SectionWindow& w = *parameters.window;
  for (const double end : {w.y_from, w.y_to, w.z_from, w.z_to, lattice.x_from, lattice.x_to}) {
    largest_end = std::max(largest_end, std::abs(end));
  }
  return 1024 * kUnitRoundoff * (std::max(1.0, largest_point) + largest_pose + 2 * largest_end);
}

SectionMotion motion_of_step(const Pose& from, const Pose& to, const Box& load) {
  SectionMotion motion;
  const auto look = [&](const PullBack& frame, const Pose& other, const Vec3& corner) {
    const Vec3 moved = difference(frame.apply(transform(other, corner)), corner);
    motion.along = std::max(motion.along, std::abs(moved.x));
    motion.across = std::max(motion.across, std::hypot(moved.y, moved.z));
  };
  const PullBack before(from), after(to);
  for (unsigned corner = 0; corner < 8; ++corner) {
    look(before, to, load.corner(corner));
    look(after, from, load.corner(corner));
  }
  return motion;
}

SectionMotion section_motion(std::span<const Pose> poses, const SectionParameters& parameters) {
  const SectionWindow& w = *parameters.window;
  const Box load{{parameters.rear, w.y_from, w.z_from}, {parameters.front, w.y_to, w.z_to}};
  SectionMotion motion;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const SectionMotion step = motion_of_step(poses[i - 1], poses[i], load);
    motion.along = std::max(motion.along, step.along);
    motion.across = std::max(motion.across, step.across);
  }
  return motion;
}

}  // namespace clearway
