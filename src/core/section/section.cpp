#include "clearway/section.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "clearway/answer.hpp"
#include "clearway/error.hpp"
#include "clearway/file_unit.hpp"
#include "core/query/verdict_words.hpp"
#include "core/section/section_intrusions.hpp"
#include "core/section/section_lattice.hpp"
#include "core/section/section_map.hpp"
#include "core/section/section_poses.hpp"
#include "core/util/format.hpp"

namespace clearway {

const char* name_of(SectionVerdict verdict) {
  switch (verdict) {
    case SectionVerdict::kPasses:
      return "passes";
    case SectionVerdict::kStopped:
      return "stopped";
    case SectionVerdict::kUnknown:
      break;
  }
  return "unknown";
}

const char* name_of(SectionTable table) {
  switch (table) {
    case SectionTable::kBands:
      return "bands";
    case SectionTable::kStations:
      return "stations";
    case SectionTable::kBoxes:
      return "boxes";
    case SectionTable::kCells:
      return "cells";
    case SectionTable::kUnknownCells:
      return "unknown-cells";
    case SectionTable::kUnknownBinCells:
      return "unknown-bin-cells";
    case SectionTable::kBinCells:
      break;
  }
  return "bin-cells";
}

void SectionCells::reserve(std::size_t cells) {
  bin.reserve(cells);
  j.reserve(cells);
  k.reserve(cells);
  first_pose.reserve(cells);
}

namespace {

/// Appends a cell of the whole path.
void append(std::int32_t j, std::int32_t k, std::uint32_t first_pose, SectionCells& cells) {
  cells.j.push_back(j);
  cells.k.push_back(k);
  cells.first_pose.push_back(first_pose);
}

/// A box of columns and rows around cells.
struct CellBox {
  std::int64_t j_from, j_to, k_from, k_to;

  explicit CellBox(const SectionCells& cells) {
    const auto [least_j, most_j] = std::ranges::minmax(cells.j);
    const auto [least_k, most_k] = std::ranges::minmax(cells.k);
    j_from = least_j;
    j_to = std::int64_t{most_j} + 1;
    k_from = least_k;
    k_to = std::int64_t{most_k} + 1;
  }
  std::uint64_t cells() const {
    return static_cast<std::uint64_t>(j_to - j_from) * static_cast<std::uint64_t>(k_to - k_from);
  }
};

/// The cells of the whole path, ascending by k, j, by an entry for each cell of a box around them.
SectionCells of_whole_path(const SectionCells& all, const CellBox& box) {
  const std::int64_t columns = box.j_to - box.j_from;
  std::vector<std::uint32_t> first(box.cells(), kNotBlocked);
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::uint32_t& of_cell =
        first[static_cast<std::size_t>((all.k[i] - box.k_from) * columns + all.j[i] - box.j_from)];
    of_cell = std::min(of_cell, all.first_pose[i]);
  }
  SectionCells out;
  for (std::size_t cell = 0; cell < first.size(); ++cell) {
    if (first[cell] == kNotBlocked) continue;
    const auto at = static_cast<std::int64_t>(cell);
    append(static_cast<std::int32_t>(box.j_from + at % columns),
           static_cast<std::int32_t>(box.k_from + at / columns), first[cell], out);
  }
  return out;
}

/// The cells of the whole path, ascending by k, j.
SectionCells of_whole_path(const SectionCells& all) {
  if (all.size() == 0) return {};
  const CellBox box(all);
  if (box.cells() <= 4 * all.size()) return of_whole_path(all, box);
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    return std::tie(all.k[a], all.j[a], all.first_pose[a]) <
           std::tie(all.k[b], all.j[b], all.first_pose[b]);
  });
  SectionCells out;
  for (const std::size_t i : order) {
    if (out.size() > 0 && out.k.back() == all.k[i] && out.j.back() == all.j[i]) continue;
    append(all.j[i], all.k[i], all.first_pose[i], out);
  }
  return out;
}

/// Those of all unknown cells of the whole path that are not blocked early enough.
SectionCells unknown_beside(const SectionCells& blocked, const SectionCells& all) {
  SectionCells out;
  std::size_t at = 0;  // in the blocked cells, which are in the same order
  for (std::size_t i = 0; i < all.size(); ++i) {
    while (at < blocked.size() &&
           std::pair(blocked.k[at], blocked.j[at]) < std::pair(all.k[i], all.j[i])) {
      ++at;
    }
    if (at < blocked.size() && blocked.k[at] == all.k[i] && blocked.j[at] == all.j[i] &&
        blocked.first_pose[at] <= all.first_pose[i]) {
      continue;
    }
    append(all.j[i], all.k[i], all.first_pose[i], out);
  }
  return out;
}

}  // namespace

SectionCells SectionData::cells() const { return of_whole_path(bin_cells); }

SectionCells SectionData::unknown_cells() const {
  return unknown ? unknown_beside(cells(), of_whole_path(*unknown)) : SectionCells{};
}

namespace {

/// A closed rectangle of the cross-section.
struct Square {
  double y_from, y_to, z_from, z_to;

  bool contains(const OutlinePoint& p) const {
    return y_from <= p.y && p.y <= y_to && z_from <= p.z && p.z <= z_to;
  }
  double distance(const OutlinePoint& p) const {
    return std::hypot(std::max({y_from - p.y, 0.0, p.y - y_to}),
                      std::max({z_from - p.z, 0.0, p.z - z_to}));
  }
  double distance(const Square& other) const {
    return std::hypot(std::max({y_from - other.y_to, 0.0, other.y_from - y_to}),
                      std::max({z_from - other.z_to, 0.0, other.z_from - z_to}));
  }
};

double distance(const OutlinePoint& p, const OutlinePoint& a, const OutlinePoint& b) {
  const double y = b.y - a.y, z = b.z - a.z;
  const double squared = y * y + z * z;
  const double along =
      squared > 0 ? std::clamp(((p.y - a.y) * y + (p.z - a.z) * z) / squared, 0.0, 1.0) : 0;
  return std::hypot(p.y - (a.y + along * y), p.z - (a.z + along * z));
}

/// Whether the segment from a to b has a place in the square (Liang and Barsky 1984).
bool crosses(const Square& square, const OutlinePoint& a, const OutlinePoint& b) {
  double from = 0, to = 1;
  const auto clip = [&](double at, double way, double lo, double hi) {
    if (way == 0) return lo <= at && at <= hi;
    const double first = (lo - at) / way, second = (hi - at) / way;
    from = std::max(from, std::min(first, second));
    to = std::min(to, std::max(first, second));
    return from <= to;
  };
  return clip(a.y, b.y - a.y, square.y_from, square.y_to) &&
         clip(a.z, b.z - a.z, square.z_from, square.z_to);
}

/// A polygon with its inside.
class Load {
 public:
  explicit Load(std::span<const OutlinePoint> outline)
      : outline_(outline), box_{outline[0].y, outline[0].y, outline[0].z, outline[0].z} {
    for (const OutlinePoint& p : outline) {
      box_ = {std::min(box_.y_from, p.y), std::max(box_.y_to, p.y), std::min(box_.z_from, p.z),
              std::max(box_.z_to, p.z)};
    }
  }

  const Square& box() const { return box_; }

  /// The distance to a square; `far` where it is certainly no smaller.
  double distance(const Square& square, double far) const {
    if (box_.distance(square) >= far) return far;
    double least = far;
    for (std::size_t i = 0; i < outline_.size(); ++i) {
      const OutlinePoint &a = outline_[i], &b = outline_[(i + 1) % outline_.size()];
      if (crosses(square, a, b)) return 0;
      least = std::min(least, square.distance(a));
      for (const double y : {square.y_from, square.y_to}) {
        for (const double z : {square.z_from, square.z_to}) {
          least = std::min(least, clearway::distance({y, z}, a, b));
        }
      }
    }
    return contains({square.y_from, square.z_from}) ? 0 : least;
  }

 private:
  /// Whether p is inside, by the edges that a ray along y crosses.
  bool contains(const OutlinePoint& p) const {
    bool inside = false;
    for (std::size_t i = 0; i < outline_.size(); ++i) {
      const OutlinePoint &a = outline_[i], &b = outline_[(i + 1) % outline_.size()];
      if ((a.z > p.z) == (b.z > p.z)) continue;
      if (a.y + (p.z - a.z) * (b.y - a.y) / (b.z - a.z) > p.y) inside = !inside;
    }
    return inside;
  }

  std::span<const OutlinePoint> outline_;
  Square box_;
};

void check_margin(double margin) {
  if (std::isfinite(margin) && margin >= 0) return;
  throw UsageError("a margin of " + format_number(margin) + "; expected 0 or more");
}

/// Whether each cell of the whole path, in its order, is closer to the load than `reach`.
std::vector<bool> needed(const SectionCells& cells, double g, const Load& load, double reach) {
  std::vector<bool> near(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double j = cells.j[i], k = cells.k[i];
    near[i] = load.distance({j * g, (j + 1) * g, k * g, (k + 1) * g}, reach) < reach;
  }
  return near;
}

}  // namespace

std::size_t index_of_cell(const SectionCells& cells, std::int32_t j, std::int32_t k) {
  std::size_t first = 0, end = cells.size();
  while (end - first > 1) {
    const std::size_t middle = first + (end - first) / 2;
    const bool before = k < cells.k[middle] || (k == cells.k[middle] && j < cells.j[middle]);
    (before ? end : first) = middle;
  }
  return first;
}

namespace {

/// The first place in each of some bins at which a load needs a cell. all: cells of the bins.
/// cells: those of the whole path. near: whether the load needs them.
std::vector<SectionStop> first_places(const SectionCells& all, SectionBinRange bins,
                                      const SectionCells& cells, const std::vector<bool>& near,
                                      const std::vector<double>& chainage) {
  std::vector<SectionStop> places;
  const auto begin = std::ranges::lower_bound(all.bin, bins.first);
  const auto end = std::upper_bound(begin, all.bin.end(), bins.last);
  for (auto i = static_cast<std::size_t>(begin - all.bin.begin());
       i < static_cast<std::size_t>(end - all.bin.begin()); ++i) {
    if (!near[index_of_cell(cells, all.j[i], all.k[i])]) continue;
    if (places.empty() || places.back().bin != all.bin[i]) {
      places.push_back({all.bin[i], kNotBlocked, 0, {}});
    }
    SectionStop& place = places.back();
    // Cells are ascending by k and j, so the first of a pose is the one to report.
    if (all.first_pose[i] >= place.first_pose) continue;
    place = {all.bin[i], all.first_pose[i], chainage[all.first_pose[i]], {all.j[i], all.k[i]}};
  }
  return places;
}

}  // namespace

std::string doubt_about(const SectionData& section) {
  std::set<std::string> codes;
  for (const Message& warning : section.warnings) {
    if (is_doubt(warning.code)) codes.insert(warning.code);
  }
  return codes.empty() ? "" : doubt_words(std::vector(codes.begin(), codes.end()));
}

namespace {

/// Whether a message is about poses of these bins, which it is where it names no stretch.
bool concerns(const Message& message, const SectionData& section, SectionBinRange bins) {
  return message.stretches.empty() || std::ranges::any_of(message.stretches, [&](PoseRange poses) {
           const auto [first, last] =
               bins_of_poses(section.chainage, poses.first, poses.last, section.parameters);
           return first <= bins.last && last >= bins.first;
         });
}

/// Why nothing could be found on stretches of the path that these bins hold, as a clause; empty
/// where something could be found everywhere. all_seen: whether beams crossed all that the load
/// needs, so that no point is missing there.
std::string doubt_about_stretches(const SectionData& section, SectionBinRange bins, bool all_seen) {
  std::set<std::string_view> codes;
  for (const Message& warning : section.warnings) {
    if (doubt_of(warning) != Doubt::kStretch || !concerns(warning, section, bins)) continue;
    if (!all_seen || !lacks_points(warning.code)) codes.insert(warning.code);
  }
  if (codes.empty()) return "";
  return "on stretches of the path nothing could be found (" + with_commas(codes) + ")";
}

/// Whether an outline is too small for any load, as in another unit; see "model-unit" of a model.
bool is_tiny(const Square& outline, const SectionFacts& section) {
  constexpr double kSmallest = 0.01;  // metres
  const bool feet = section.length_unit.ends_with("foot");
  const double side = std::max(outline.y_to - outline.y_from, outline.z_to - outline.z_from);
  return side * (feet ? kMetresPerFoot : 1) < kSmallest;
}

}  // namespace

double reach_of(const SectionFacts& section, double margin) {
  return (section.motion ? margin + (*section.motion)[1] / 2 : margin) + section.rounding;
}

std::vector<bool> stopping_cells(const Section& section, std::span<const OutlinePoint> outline,
                                 double margin) {
  check_margin(margin);
  outline_model(outline, 0, 1);  // refuses what is no outline
  return needed(section.cells(), section.data().parameters.cell, Load(outline),
                reach_of(section.data(), margin));
}

Section::Section(SectionData data) : data_(std::move(data)), cells_(data_.cells()) {
  if (!data_.unknown) return;
  ever_unknown_ = of_whole_path(*data_.unknown);
  unknown_ = unknown_beside(cells_, ever_unknown_);
}

SectionGrid Section::grid() const {
  const SectionLattice lattice = lattice_of(data_);
  return {static_cast<std::int32_t>(lattice.j_from), static_cast<std::int32_t>(lattice.j_to),
          static_cast<std::int32_t>(lattice.k_from), static_cast<std::int32_t>(lattice.k_to)};
}

SectionCheck Section::check(std::span<const OutlinePoint> outline,
                            std::optional<double> asked_margin, SectionBinRange bins) const {
  const double margin = asked_margin.value_or(data_.parameters.margin);
  const std::vector<bool> stops = stopping_cells(*this, outline, margin);
  const Load load(outline);
  const double g = data_.parameters.cell;
  const double reach = reach_of(data_, margin);
  SectionCheck check;
  check.stops = first_places(data_.bin_cells, bins, cells_, stops, data_.chainage);
  if (data_.unknown) {
    check.unknowns = first_places(*data_.unknown, bins, ever_unknown_,
                                  needed(ever_unknown_, g, load, reach), data_.chainage);
  }
  if (!check.stops.empty()) {
    find_intrusions(*this, outline, reach, stops, check.stops);
    check.verdict = SectionVerdict::kStopped;
    check.stop = check.stops.front();
    return check;
  }
  const SectionLattice lattice = lattice_of(data_);
  const double edge = data_.motion ? reach : margin;
  const Square& box = load.box();
  check.reason = doubt_about(data_);
  if (margin > data_.parameters.margin) {
    check.reason = "the section was found for margins up to " +
                   format_number(data_.parameters.margin) + " only";
  } else if (box.y_from - edge < lattice.j_from * g || box.y_to + edge > lattice.j_to * g ||
             box.z_from - edge < lattice.k_from * g || box.z_to + edge > lattice.k_to * g) {
    check.reason = "the load with its margin leaves the window of the section";
  } else if (check.reason.empty() && is_tiny(box, data_)) {
    check.reason = "the outline is " + format_brief(box.y_to - box.y_from) + " wide and " +
                   format_brief(box.z_to - box.z_from) +
                   " high, so its unit is probably another one";
  } else if (check.reason.empty() && !check.unknowns.empty()) {
    check.reason = "no beam of the scanner crossed a place that the load needs, first at pose " +
                   std::to_string(check.unknowns.front().first_pose) + ", " +
                   format_brief(check.unknowns.front().chainage) + " along the path";
  }
  if (check.reason.empty()) {
    check.reason = doubt_about_stretches(data_, bins, data_.unknown.has_value());
  }
  check.verdict = check.reason.empty() ? SectionVerdict::kPasses : SectionVerdict::kUnknown;
  return check;
}

std::vector<bool> Section::free_cells(std::optional<double> asked_margin) const {
  const double margin = asked_margin.value_or(data_.parameters.margin);
  check_margin(margin);
  const SectionLattice lattice = lattice_of(data_);
  const auto columns = static_cast<std::int64_t>(lattice.columns);
  const auto rows = static_cast<std::int64_t>(lattice.rows);
  std::vector<bool> free(lattice.cells());
  if (margin > data_.parameters.margin || !doubt_about(data_).empty()) return free;
  const double g = lattice.cell, squared_cell = g * g, squared_margin = margin * margin;
  // For each difference of rows the greatest difference of columns at which a cell is too close.
  std::vector<std::int64_t> reach{0};
  const auto too_close = [&](std::int64_t column, std::int64_t row) {
    const auto a = static_cast<double>(std::max<std::int64_t>(column - 1, 0));
    const auto b = static_cast<double>(std::max<std::int64_t>(row - 1, 0));
    return (a * a + b * b) * squared_cell < squared_margin;
  };
  for (std::int64_t row = 0; row < rows && (row == 0 || too_close(0, row)); ++row) {
    std::int64_t column = 0;
    while (column + 1 < columns && too_close(column + 1, row)) ++column;
    if (row == 0) {
      reach[0] = column;
    } else {
      reach.push_back(column);
    }
  }
  std::vector<bool> taken(free.size());
  const auto take = [&](std::int64_t j, std::int64_t k) {
    const auto up = static_cast<std::int64_t>(reach.size()) - 1;
    for (std::int64_t row = std::max<std::int64_t>(k - up, 0); row <= std::min(k + up, rows - 1);
         ++row) {
      const std::int64_t across = reach[static_cast<std::size_t>(std::abs(row - k))];
      const auto from = taken.begin() + row * columns + std::max<std::int64_t>(j - across, 0);
      const auto to = taken.begin() + row * columns + std::min(j + across, columns - 1) + 1;
      std::fill(from, to, true);
    }
  };
  for (const SectionCells* const cells : {&cells_, &unknown_}) {
    for (std::size_t i = 0; i < cells->size(); ++i) {
      take(cells->j[i] - static_cast<std::int64_t>(lattice.j_from),
           cells->k[i] - static_cast<std::int64_t>(lattice.k_from));
    }
  }
  for (std::int64_t k = 0; k < rows; ++k) {
    for (std::int64_t j = 0; j < columns; ++j) {
      const std::int64_t border = std::min({j, columns - 1 - j, k, rows - 1 - k});
      const auto i = static_cast<std::size_t>(k * columns + j);
      free[i] = !taken[i] && static_cast<double>(border) * g >= margin;
    }
  }
  return free;
}

}  // namespace clearway
