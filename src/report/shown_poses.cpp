#include "report/shown_poses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include "io/files/parallel_loop.hpp"

namespace clearway {
namespace {

std::int32_t whole(double value) {
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::clamp(std::round(value), -kMost, kMost));
}

/// A column with one number for each shown pose.
struct NumberColumn {
  std::string name;
  std::vector<std::int32_t> values;
};

class PoseColumns {
 public:
  PoseColumns(std::span<const std::uint32_t> shown, std::vector<NumberColumn>& columns)
      : shown_(shown), columns_(columns) {}

  /// Adds a column. number(i) gives the value of pose i.
  template <typename Number>
  void add(std::string name, const Number& number) {
    NumberColumn column{std::move(name), {}};
    column.values.reserve(shown_.size());
    for (const std::uint32_t i : shown_) column.values.push_back(whole(number(i)));
    columns_.push_back(std::move(column));
  }

 private:
  std::span<const std::uint32_t> shown_;
  std::vector<NumberColumn>& columns_;
};

void add_places(PoseColumns& out, std::span<const Pose> poses, const PageLattice& lattice) {
  static constexpr const char* kPlace[] = {"pose.x", "pose.y", "pose.z"};
  static constexpr const char* kRotation[] = {"pose.r0", "pose.r1", "pose.r2", "pose.r3", "pose.r4",
                                              "pose.r5", "pose.r6", "pose.r7", "pose.r8"};
  for (int k = 0; k < 3; ++k) {
    out.add(kPlace[k], [&](std::uint32_t i) {
      return (poses[i].translation[k] - lattice.origin[k]) / lattice.step;
    });
  }
  for (int k = 0; k < 9; ++k) {
    out.add(kRotation[k], [&](std::uint32_t i) { return poses[i].rotation[k] / kRotationStep; });
  }
}

void add_profile(PoseColumns& out, const Profile& profile, const PageLattice& lattice) {
  static constexpr const char* kPoint[] = {"pose.px", "pose.py", "pose.pz"};
  out.add("pose.distance", [&](std::uint32_t i) {
    return std::isfinite(profile.distance[i]) ? profile.distance[i] / kDistanceStep : kNoDistance;
  });
  for (int k = 0; k < 3; ++k) {
    out.add(kPoint[k], [&](std::uint32_t i) {
      if (profile.source[i] == Profile::kNoPoint) return 0.0;
      return (profile.xyz[i][k] - lattice.origin[k]) / lattice.step;
    });
  }
}

/// A text for each shown pose, in lines.
std::string lines_of(std::span<const std::uint32_t> shown, const std::vector<std::string>& texts) {
  std::string out;
  for (const std::uint32_t i : shown) {
    for (const char c : texts[i]) out += c == '\n' ? ' ' : c;
    out += '\n';
  }
  return out;
}

/// The page's column of a label.
template <typename Type>
std::string column_of(const PoseLabel<Type>& label) {
  return std::string("pose.") + label.key;
}

}  // namespace

double origin_on_page(const PoseLabel<double>& label, const std::vector<double>& values) {
  return label.is_counted_from_first ? values.front() : 0;
}

std::vector<std::uint32_t> choose_poses(std::uint64_t poses, const Profile& profile,
                                        const std::vector<Conflict>& conflicts, std::size_t most) {
  std::vector<std::uint32_t> shown;
  if (poses == 0) return shown;
  const std::uint64_t stretches = std::min<std::uint64_t>(poses, most);
  for (std::uint64_t k = 0; k < stretches; ++k) {
    const std::uint64_t first = k * poses / stretches, end = (k + 1) * poses / stretches;
    std::uint64_t best = first;
    for (std::uint64_t i = first + 1; i < end && !profile.distance.empty(); ++i) {
      if (profile.distance[i] < profile.distance[best]) best = i;
    }
    shown.push_back(static_cast<std::uint32_t>(best));
  }
  shown.push_back(0);
  shown.push_back(static_cast<std::uint32_t>(poses - 1));
  for (const Conflict& conflict : conflicts) {
    shown.push_back(conflict.first_pose);
    shown.push_back(conflict.last_pose);
    if (conflict.nearest_pose) shown.push_back(*conflict.nearest_pose);
  }
  std::ranges::sort(shown);
  shown.erase(std::unique(shown.begin(), shown.end()), shown.end());
  return shown;
}

void append_pose_columns(std::span<const std::uint32_t> shown, std::span<const Pose> poses,
                         std::span<const double> chainage, const Profile& profile,
                         const PoseLabels& labels, const PageLattice& lattice,
                         std::vector<PageColumn>& columns) {
  std::vector<NumberColumn> numbers;
  PoseColumns out(shown, numbers);
  out.add("pose.index", [](std::uint32_t i) { return i; });
  add_places(out, poses, lattice);
  out.add("pose.chainage", [&](std::uint32_t i) { return chainage[i] / kChainageStep; });
  if (!profile.distance.empty()) add_profile(out, profile, lattice);
  for_each_label([&](const auto& label) {
    if constexpr (!std::decay_t<decltype(label)>::is_text()) {
      const std::vector<double>& values = label.of(labels);
      if (values.empty()) return;
      const double origin = origin_on_page(label, values);
      out.add(column_of(label), [&](std::uint32_t i) { return (values[i] - origin) / kLabelStep; });
    }
  });
  const std::size_t first = columns.size();
  for (const NumberColumn& column : numbers) columns.push_back({column.name, {}});
  for_each_parallel(numbers.size(), [&](std::size_t k) {
    columns[first + k].base64 = deflated_base64(delta_planes(numbers[k].values));
  });
  for_each_label([&](const auto& label) {
    if constexpr (std::decay_t<decltype(label)>::is_text()) {
      const std::vector<std::string>& texts = label.of(labels);
      if (!texts.empty()) {
        columns.push_back({column_of(label), deflated_base64(lines_of(shown, texts))});
      }
    }
  });
}

}  // namespace clearway
