#include "findings/match_conflicts.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <tuple>

namespace clearway {
namespace {

struct Candidate {
  /// Volume that the grown boxes have in common.
  double volume;
  /// Where the volume is 0, the sum of the sides that the boxes themselves have in common.
  double sides;
  /// Ids of the two conflicts.
  std::uint32_t a, b;

  bool before(const Candidate& other) const {
    return std::tuple(-volume, -sides, a, b) <
           std::tuple(-other.volume, -other.sides, other.a, other.b);
  }
};

double common_volume(const Box& a, const Box& b) {
  double volume = 1;
  for (int k = 0; k < 3; ++k) {
    const double side = std::min(a.hi[k], b.hi[k]) - std::max(a.lo[k], b.lo[k]);
    if (!(side > 0)) return 0;
    volume *= side;
  }
  return volume;
}

/// The sum of the sides that two boxes share, 0 where they touch in a point; nothing where they do
/// not touch. Beside large coordinates a small gap is rounded away, and flat boxes share no volume.
std::optional<double> common_sides(const Box& a, const Box& b) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double side = std::min(a.hi[k], b.hi[k]) - std::max(a.lo[k], b.lo[k]);
    if (!(side >= 0)) return std::nullopt;
    sum += side;
  }
  return sum;
}

/// Indices of the conflicts in the order of their boxes along x.
std::vector<std::uint32_t> along_x(const Conflicts& conflicts) {
  std::vector<std::uint32_t> order(conflicts.listed.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {},
                           [&](std::uint32_t i) { return conflicts.listed[i].box.lo.x; });
  return order;
}

/// All pairs that overlap, found by a sweep along x: for each conflict of a, those of b are looked
/// at that begin before its box ends, and not farther before its box than the longest box of b
/// reaches.
std::vector<Candidate> candidates(const Conflicts& a, const Conflicts& b, double gap) {
  const std::vector<std::uint32_t> order = along_x(b);
  double longest = 0;
  for (const Conflict& c : b.listed) longest = std::max(longest, c.box.hi.x - c.box.lo.x);
  std::vector<Candidate> out;
  for (const Conflict& in_a : a.listed) {
    const Box box = in_a.box.grown(gap);
    const double from = box.lo.x - longest - 2 * gap;
    auto next = std::ranges::lower_bound(order, from, {},
                                         [&](std::uint32_t i) { return b.listed[i].box.lo.x; });
    for (; next != order.end(); ++next) {
      const Conflict& in_b = b.listed[*next];
      const Box other = in_b.box.grown(gap);
      if (other.lo.x > box.hi.x) break;
      const double volume = common_volume(box, other);
      const std::optional<double> sides = volume > 0 ? 0 : common_sides(in_a.box, in_b.box);
      if (sides) out.push_back({volume, *sides, in_a.id, in_b.id});
    }
  }
  std::ranges::sort(out, [](const Candidate& x, const Candidate& y) { return x.before(y); });
  return out;
}

std::vector<std::uint32_t> unmatched(const std::vector<bool>& matched) {
  std::vector<std::uint32_t> ids;
  for (std::uint32_t id = 1; id < matched.size(); ++id) {
    if (!matched[id]) ids.push_back(id);
  }
  return ids;
}

}  // namespace

ConflictMatch match_conflicts(const Conflicts& a, const Conflicts& b, double gap) {
  std::vector<bool> in_a(a.listed.size() + 1), in_b(b.listed.size() + 1);
  ConflictMatch out;
  for (const Candidate& candidate : candidates(a, b, gap)) {
    if (in_a[candidate.a] || in_b[candidate.b]) continue;
    in_a[candidate.a] = in_b[candidate.b] = true;
    out.same.emplace_back(candidate.a, candidate.b);
  }
  std::ranges::sort(out.same);
  out.gone = unmatched(in_a);
  out.added = unmatched(in_b);
  return out;
}

}  // namespace clearway
