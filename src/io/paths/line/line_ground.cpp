#include "io/paths/line/line_ground.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/store.hpp"
#include "core/geometry/angle.hpp"
#include "core/trajectory/line/ground.hpp"
#include "core/util/format.hpp"
#include "io/paths/poses_along.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {
namespace {

/// The places at which the ground is looked for.
std::vector<GroundPlace> places_of(const LineVertices& line, const LinePath& path) {
  std::vector<GroundPlace> places;
  for (const double station : even_stations(0, path.plan.length(), kGroundStep)) {
    places.push_back({station, path.plan.at(station)});
    if (!line.z.empty()) places.back().height = path.height_at(station).value;
  }
  return places;
}

std::string place_text(const GroundPlace& place) {
  return format_digits(place.plan.at.real(), 9) + " " + format_digits(place.plan.at.imag(), 9);
}

/// One side of the vehicle, with its name for messages.
struct NamedSide {
  const char* name;
  GroundSide ground;
};

[[noreturn]] void refuse_gap(const std::string& name, const NamedSide& side,
                             const GroundPlace& from, const GroundPlace& to) {
  const std::string risen =
      side.ground.risen == 0
          ? ""
          : ". On this side, " + counted(side.ground.risen, "place") +
                (side.ground.risen == 1 ? " was" : " were") +
                " dropped because what was found there rises too steeply to be ground";
  const double spacing =
      std::sqrt(kGroundStripLength * kGroundStripWidth / static_cast<double>(kFewestGroundPoints));
  const std::string sparse = side.ground.sparse == 0
                                 ? ""
                                 : ". On this side, " + counted(side.ground.sparse, "place") +
                                       (side.ground.sparse == 1 ? " has" : " have") +
                                       " too few points: the ground takes points at most " +
                                       format_brief(spacing) + " m apart";
  refuse(name,
         "no ground was found under the {} wheels for {} m, from {} m along the line (at {}) to {} "
         "m (at {}); expected gaps of at most {} m. The scan may have a hole there, something may "
         "stand on the ground, or the height of the line may be more than 1 m off{}{}",
         side.name, format_brief(to.station - from.station), format_brief(from.station),
         place_text(from), format_brief(to.station), place_text(to),
         format_brief(kLongestGroundGap), risen, sparse);
}

/// The longest gap between two places with ground, in metres. Refuses one that is too long to be
/// bridged, also at the ends.
double longest_gap(const std::string& name, const NamedSide& side,
                   std::span<const GroundPlace> places) {
  const std::vector<std::size_t>& found = side.ground.places;
  if (found.empty()) refuse_gap(name, side, places.front(), places.back());
  double longest = 0;
  const auto look_at = [&](std::size_t from, std::size_t to) {
    const double gap = places[to].station - places[from].station;
    if (gap > kLongestGroundGap + kSameStation) refuse_gap(name, side, places[from], places[to]);
    return gap;
  };
  look_at(0, found.front());
  look_at(found.back(), places.size() - 1);
  for (std::size_t i = 0; i + 1 < found.size(); ++i) {
    const double gap = look_at(found[i], found[i + 1]);
    if (found[i + 1] > found[i] + 1) longest = std::max(longest, gap);
  }
  return longest;
}

void remark_ends(const std::string& name, std::span<const GroundPlace> places, std::size_t first,
                 std::size_t last, LineFile& out) {
  const double begins = places[first].station, ends = places.back().station - places[last].station;
  if (first == 0 && last + 1 == places.size()) return;
  out.warn("ground-ends",
           name + ": at the ends of the line no ground was found, so the poses begin " +
               format_brief(begins) + " m later and end " + format_brief(ends) + " m earlier",
           {{"begins_after", begins}, {"ends_before", ends}});
}

void remark_ground(const std::string& name, const LineOptions& options, LineFile& out) {
  const GroundFinding& found = *out.ground;
  const auto of_all = [&](std::size_t count) {
    return format_count(count) + " of " + format_count(found.places);
  };
  const std::string bridged =
      found.longest_bridged == 0
          ? ""
          : "; the longest gap that was bridged is " + format_brief(found.longest_bridged) + " m";
  out.note("on-ground",
           {{"left", found.left},
            {"right", found.right},
            {"places", found.places},
            {"longest_bridged", found.longest_bridged}},
           "{}: height and roll are those of the ground in {} under wheels {} m apart, which was "
           "found at {} places on the left and at {} on the right{}. Under a parked car the ground "
           "is not seen, so there the path may be about 0.3 m too high",
           name, options.ground->path().string(), format_brief(*options.track), of_all(found.left),
           of_all(found.right), bridged);
}

/// Refuses ground on which no vehicle stands.
void check_roll(const std::string& name, const GroundPlace& place, double difference,
                double track) {
  if (std::abs(difference) < track / 2) return;
  refuse(name, "the ground under the left wheels is " + format_brief(difference) +
                   " m above that under the right ones, which are " + format_brief(track) +
                   " m away, " + format_brief(place.station) + " m along the line at " +
                   place_text(place) + "; expected less than half of the track");
}

/// Warns of ground on which a vehicle would lean more than on any road. cant: differences of height
/// between left and right, by station.
void remark_lean(const std::string& name, const std::vector<CantPoint>& cant, double track,
                 const LinePath& path, LineFile& out) {
  constexpr double kMostLean = 0.15;
  const CantPoint& worst = *std::ranges::max_element(
      cant, {}, [](const CantPoint& point) { return std::abs(point.cant); });
  if (!(std::abs(worst.cant) > kMostLean * track)) return;
  const double degrees = std::asin(std::abs(worst.cant) / track) / kDegree;
  out.warn("ground-leans", {{"degrees", degrees}, {"station", worst.station}},
           "{}: on this ground the vehicle leans by up to {} degrees, {} m along the line (at {}), "
           "because the ground under its {} wheels is {} m higher; something such as a parked car "
           "may stand there and hide the ground",
           name, format_brief(degrees), format_brief(worst.station),
           place_text({worst.station, path.plan.at(worst.station)}),
           worst.cant > 0 ? "left" : "right", format_brief(std::abs(worst.cant)));
}

/// Sets height and cant of a path by the ground under its wheels. places: of the heights on either
/// side.
void stand_on(const std::string& name, std::span<const GroundPlace> places,
              std::span<const double> left, std::span<const double> right, double track,
              LinePath& path, LineFile& out) {
  std::vector<double> stations, heights;
  std::vector<CantPoint> cant;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double difference = left[i] - right[i];
    check_roll(name, places[i], difference, track);
    stations.push_back(places[i].station);
    heights.push_back(right[i] + difference / 2);
    cant.push_back({places[i].station, difference});
  }
  remark_lean(name, cant, track, path, out);
  path.height.emplace<HeightCurve>(std::move(stations), heights);
  path.cant.emplace(std::move(cant));
  path.cant_line = CantLine::kCenter;
  path.rail_distance = track;
}

}  // namespace

Reach put_on_ground(const std::string& name, const LineVertices& line, const LineOptions& options,
                    LinePath& path, LineFile& out) {
  if (!line.cant.empty() && options.cant != CantLine::kNone) {
    throw UsageError(
        name +
        ": the line has cant, and the ground gives the roll too; expected one of both, "
        "so leave out the cant");
  }
  if (options.ground->reader().metadata().near) {
    throw UsageError(options.ground->path().string() +
                     ": holds only points within a distance of a path, so the ground may have been "
                     "left out; expected a store of the whole scans");
  }
  const double track = *options.track, metre = 1 / options.environment_unit;
  const std::vector<GroundPlace> places = places_of(line, path);
  const auto side = [&](const char* which, double left) {
    return NamedSide{which, find_ground(options.ground->reader(), places,
                                        {.left = left, .metre = metre, .begin = options.height})};
  };
  const NamedSide left = side("left", track / 2), right = side("right", -track / 2);
  const double gap_left = longest_gap(name, left, places);
  const double gap_right = longest_gap(name, right, places);
  out.ground = GroundFinding{.places = places.size(),
                             .left = left.ground.places.size(),
                             .right = right.ground.places.size(),
                             .risen = left.ground.risen + right.ground.risen,
                             .longest_bridged = std::max(gap_left, gap_right)};
  const std::size_t first = std::max(left.ground.places.front(), right.ground.places.front());
  const std::size_t last = std::min(left.ground.places.back(), right.ground.places.back());
  if (first >= last) {
    refuse(name,
           "the ground is known under both wheels at one place at most; expected it along "
           "the line");
  }
  stand_on(name, std::span(places).subspan(first, last + 1 - first),
           left.ground.bridged(places, first, last), right.ground.bridged(places, first, last),
           track, path, out);
  remark_ground(name, options, out);
  remark_ends(name, places, first, last, out);
  return {places[first].station, places[last].station};
}

}  // namespace clearway
