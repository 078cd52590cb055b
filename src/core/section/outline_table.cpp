// The answer of a section to a table of outlines: docs/design/section.md, "Outlines by station".
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/section.hpp"
#include "core/section/section_lattice.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

/// Where a stretch ends that goes on beyond the path.
constexpr double kEndless = std::numeric_limits<double>::infinity();
/// An end of the table this close to an end of the path is that end: tables hold rounded numbers.
constexpr double kSameEnd = 0.001;

[[noreturn]] void refuse(const OutlineTable& table, const OutlineRow& row,
                         const std::string& what) {
  throw UsageError(table.path.string() + ": line " + std::to_string(row.line) + ": " + what);
}

/// A part of the path from `from` up to `to`, without `to`.
struct PathPart {
  double from, to;
};

/// Chainages of the places at which an alignment has these stations. Beyond the path's ends they
/// grow as stations do.
class ChainageOfStation {
 public:
  ChainageOfStation(const OutlineTable& table, const std::vector<double>& chainage,
                    std::span<const double> station)
      : chainage_(chainage), station_(station) {
    const std::string why = table.path.string() + ": its rows are by station, ";
    if (station.empty()) {
      throw UsageError(why +
                       "but no stations of the path are known; expected the trajectory with "
                       "its stations");
    }
    if (station.size() != chainage.size()) {
      throw UsageError(why + "but the path has " + counted(chainage.size(), "pose") + " and " +
                       counted(station.size(), "station"));
    }
    for (std::size_t i = 0; i + 1 < station.size(); ++i) {
      const bool ascends = station[i] < station[i + 1] ||
                           (station[i] == station[i + 1] && chainage[i] == chainage[i + 1]);
      if (ascends) continue;
      throw UsageError(why + "but the stations of the path do not ascend from pose " +
                       std::to_string(i) + " (" + format_brief(station[i]) + ") to pose " +
                       std::to_string(i + 1) + " (" + format_brief(station[i + 1]) +
                       "); expected rows by chainage");
    }
  }

  double operator()(double station) const {
    if (station < station_.front()) return chainage_.front() - (station_.front() - station);
    if (station > station_.back()) return chainage_.back() + (station - station_.back());
    return value_at(station_, chainage_, station);
  }

 private:
  std::span<const double> chainage_, station_;
};

std::vector<PathPart> stretches_of(const OutlineTable& table, const std::vector<double>& chainage,
                                   std::span<const double> station) {
  std::vector<PathPart> out;
  for (const OutlineRow& row : table.rows) out.push_back({row.from, row.to});
  if (!table.by_station) return out;
  const ChainageOfStation chainage_of(table, chainage, station);
  for (PathPart& stretch : out) stretch = {chainage_of(stretch.from), chainage_of(stretch.to)};
  return out;
}

/// Moves the ends of the table that are ends of a path of this length to infinity. stretches:
/// ascending and apart from each other.
void to_the_ends(std::vector<PathPart>& stretches, double length) {
  const auto first = std::ranges::find_if(stretches, [](const PathPart& s) { return s.to > 0; });
  if (first != stretches.end() && first->from <= kSameEnd) first->from = -kEndless;
  const auto last = std::find_if(stretches.rbegin(), stretches.rend(),
                                 [&](const PathPart& s) { return s.from <= length; });
  if (last != stretches.rend() && last->to >= length - kSameEnd) last->to = kEndless;
}

/// The bins of a section that hold places of stretches of its path.
class BinsOfStretches {
 public:
  explicit BinsOfStretches(const SectionData& data) : data_(data) {}

  /// None where the load has no pose in them.
  std::optional<SectionBinRange> touched_by(const PathPart& stretch) const {
    if (data_.bins.empty() || stretch.from > data_.chainage.back()) return std::nullopt;
    const double last = data_.bins.back(), side = data_.parameters.bin;
    const double last_place = std::nextafter(stretch.to, stretch.from);
    const double from = std::max(std::floor(stretch.from / side), 0.0);
    const double to = std::min(std::floor(last_place / side), last);
    if (!(from <= to)) return std::nullopt;
    const SectionBinRange bins{static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(to)};
    const auto at = std::ranges::lower_bound(data_.bins, bins.first);
    if (at == data_.bins.end() || !bins.contains(*at)) return std::nullopt;
    return bins;
  }

 private:
  const SectionData& data_;
};

/// The parts of the path that no stretch holds. stretches: ascending and apart from each other.
std::vector<PathPart> gaps_between(std::span<const PathPart> stretches) {
  std::vector<PathPart> gaps;
  double end = -kEndless;
  for (const PathPart& stretch : stretches) {
    if (stretch.from > end) gaps.push_back({end, stretch.from});
    end = stretch.to;
  }
  if (end < kEndless) gaps.push_back({end, kEndless});
  return gaps;
}

/// Fills what the whole table says of what its rows and gaps say.
void conclude(const OutlineTable& table, OutlineTableCheck& out) {
  const OutlineRowCheck* first_unknown = nullptr;
  const bool any_judged = std::ranges::any_of(
      out.rows, [](const OutlineRowCheck& row) { return row.bins.has_value(); });
  for (std::size_t i = 0; i < out.rows.size(); ++i) {
    const OutlineRowCheck& row = out.rows[i];
    const auto append = [i](const std::vector<SectionStop>& from, std::vector<SectionStop>& to) {
      for (SectionStop place : from) {
        place.row = i;
        to.push_back(std::move(place));
      }
    };
    append(row.check.stops, out.stops);
    append(row.check.unknowns, out.unknowns);
    if (row.bins && row.check.verdict == SectionVerdict::kUnknown && first_unknown == nullptr) {
      first_unknown = &row;
    }
  }
  for (auto* places : {&out.stops, &out.unknowns}) {
    std::ranges::stable_sort(*places, {}, &SectionStop::bin);
  }
  if (!out.stops.empty()) {
    out.verdict = SectionVerdict::kStopped;
    out.stop = *std::ranges::min_element(out.stops, {}, &SectionStop::first_pose);
  } else if (first_unknown != nullptr) {
    out.reason = "line " + std::to_string(first_unknown->line) + " of " +
                 table.path.filename().string() + ": " + first_unknown->check.reason;
  } else if (!out.gaps.empty()) {
    out.reason =
        "the table has no outline from " + format_brief(out.gaps.front().chainage_from) + " to " +
        format_brief(out.gaps.front().chainage_to) + " along the path" +
        (out.gaps.size() == 1 ? "" : ", and " + counted(out.gaps.size() - 1, "further gap"));
  } else if (!any_judged) {
    out.reason = "the load has no pose on the path of any row";
  } else {
    out.verdict = SectionVerdict::kPasses;
  }
}

}  // namespace

OutlineTableCheck Section::check(const OutlineTable& table, std::optional<double> margin,
                                 std::span<const double> station) const {
  const std::vector<double>& chainage = data_.chainage;
  const double length = chainage.empty() ? 0 : chainage.back();
  const BinsOfStretches bins(data_);
  const std::vector<PathPart> given = stretches_of(table, chainage, station);
  std::vector<PathPart> stretches = given;
  to_the_ends(stretches, length);
  OutlineTableCheck out;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const OutlineRow& row = table.rows[i];
    OutlineRowCheck judged{.line = row.line,
                           .file = row.file,
                           .chainage_from = given[i].from,
                           .chainage_to = given[i].to};
    judged.margin = row.margin.value_or(margin.value_or(data_.parameters.margin));
    judged.bins = bins.touched_by(stretches[i]);
    try {
      // A row that judges nothing is checked, too, because its outline may be none.
      judged.check = check(row.outline, judged.margin, judged.bins.value_or(SectionBinRange{}));
    } catch (const UsageError& error) {
      refuse(table, row, row.file.string() + ": " + error.what());
    }
    if (!judged.bins) {
      judged.check = {.reason = "the load has no pose on this part of the path"};
    }
    out.rows.push_back(std::move(judged));
  }
  for (const PathPart& gap : gaps_between(stretches)) {
    const auto touched = bins.touched_by(gap);
    if (!touched) continue;
    out.gaps.push_back({std::max(gap.from, 0.0), std::min(gap.to, length), *touched});
  }
  conclude(table, out);
  return out;
}

}  // namespace clearway
