#include "io/paths/line/line_file.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/store.hpp"
#include "core/geometry/angle.hpp"
#include "core/messages/messages.hpp"
#include "core/trajectory/line/line_path.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/paths/line/line_ground.hpp"
#include "io/paths/line/line_vertices.hpp"
#include "io/paths/poses_along.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {
namespace {

void check_number(const std::optional<double>& value, const char* name, bool above_0,
                  const char* expected) {
  if (!value || (std::isfinite(*value) && (!above_0 || *value > 0))) return;
  throw UsageError(std::string(name) + ": " + format_digits(*value, 9) + "; expected " + expected);
}

void check_options(const LineOptions& options) {
  check_number(options.step, "step", true, "a length above 0");
  check_number(options.corner_radius, "corner radius", true, "a length above 0");
  check_number(options.rail_distance, "rail distance", true, "a length above 0");
  check_number(options.height, "height", false, "a finite height");
  check_number(options.track, "track", true, "a length above 0");
  if ((options.ground != nullptr) != options.track.has_value()) {
    throw UsageError(
        "the ground gives height and roll only together with the track, the distance between the "
        "left and the right wheels; expected both or neither");
  }
}

/// A vertex in words: "vertex 3 at 512.25 77.1".
std::string vertex_text(const LineVertices& line, std::size_t vertex) {
  return "vertex " + std::to_string(vertex + 1) + " at " + format_digits(line.x[vertex], 9) + " " +
         format_digits(line.y[vertex], 9);
}

struct Range {
  double least, greatest;
  double width() const { return greatest - least; }
};

Range range_of(const std::vector<double>& values) {
  const auto [least, greatest] = std::ranges::minmax(values);
  return {least, greatest};
}

/// Refuses coordinates that are longitude and latitude by their size, or warns of them. A path of
/// less than half a metre makes no sense, and one of more than 5 degrees leads through countries.
void check_degrees(const std::string& name, const LineVertices& line, Remarks& out) {
  constexpr double kSurely = 0.5, kMaybe = 5;
  if (line.unit.is_known()) return;
  const Range x = range_of(line.x), y = range_of(line.y);
  const double unit = line.metres_per_unit;
  const bool on_globe = std::max(std::abs(x.least), std::abs(x.greatest)) <= 180 * unit &&
                        std::max(std::abs(y.least), std::abs(y.greatest)) <= 90 * unit;
  const double extent = std::max(x.width(), y.width()) / unit;
  if (!on_globe || extent > kMaybe) return;
  const std::string text =
      name + ": the coordinates reach from " + format_digits(x.least / unit, 9) + " " +
      format_digits(y.least / unit, 9) + " to " + format_digits(x.greatest / unit, 9) + " " +
      format_digits(y.greatest / unit, 9) +
      (extent > kSurely ? ", which may be longitude and latitude"
                        : ", which are longitude and latitude or a line of less than half a metre");
  const std::string advice =
      "; the system of the scan is expected, so transform degrees to it first, for example with "
      "ogr2ogr -t_srs or in a GIS";
  if (extent <= kSurely) {
    throw InputError(text + advice + ". Where they are lengths, their unit has to be named",
                     Remedy::kDeclareLength);
  }
  out.warn("line-degrees", text + advice, {{"extent", extent}});
}

void remark_unit(const std::string& name, const LineVertices& line, const LineOptions& options,
                 Remarks& out) {
  const double metres = line.metres_per_unit;
  if (line.unit.is_known() && metres != 1 && options.environment_unit_is_assumed) {
    out.warn("unit-assumed", unit_assumed_text(name + ": its coordinates", metres),
             {{"metres", metres}});
  }
  if (metres != 1) {
    out.note(
        "trajectory-unit",
        name + ": positions were multiplied by " + format_digits(metres, 9) + " to give metres",
        {{"metres", metres}});
  }
  if (!is_foot(metres) || !is_foot(options.environment_unit)) return;
  const Range x = range_of(line.x), y = range_of(line.y);
  const double largest =
      std::max({std::abs(x.least), std::abs(x.greatest), std::abs(y.least), std::abs(y.greatest)});
  const double moved = feet_apart(largest, metres, options.environment_unit);
  if (metres == options.environment_unit || !(moved > kFeetApart)) return;
  out.warn("two-feet",
           two_feet_text(name + ": its positions", metres, options.environment_unit, moved),
           {{"metres", moved}});
}

void remark_crs(const std::string& name, const LineVertices& line, const LineOptions& options,
                Remarks& out) {
  if (const auto other = other_epsg(line.epsg, options.environment_crs)) {
    out.warn("line-crs", other_crs_text(name, line.epsg, *other, "line"),
             {{"line", static_cast<double>(line.epsg)}, {"environment", *other}});
  }
}

/// Length in metres of the legs together, in plan.
double length_of_legs(const std::vector<PlanPoint>& vertices) {
  double sum = 0;
  for (std::size_t i = 1; i < vertices.size(); ++i) sum += std::abs(vertices[i] - vertices[i - 1]);
  return sum;
}

void remark_stations(const std::string& name, const LineVertices& line,
                     const std::vector<PlanPoint>& vertices, Remarks& out) {
  if (line.station.empty()) return;
  const std::vector<double>& stations = line.station;
  constexpr double kLikeLength = 0.05;
  const double length = length_of_legs(vertices);
  const double reach = std::abs(stations.back() - stations.front());
  const bool ascends = stations.back() >= stations.front();
  for (std::size_t i = 1; i < stations.size(); ++i) {
    if (stations[i] != stations[i - 1] && (stations[i] > stations[i - 1]) == ascends) continue;
    out.warn("station-order",
             name + ": " + line.place_of(i) + ": the station " + format_digits(stations[i], 9) +
                 " m comes after " + format_digits(stations[i - 1], 9) +
                 " m, so stations do not run evenly along the line",
             {{"vertex", static_cast<double>(i + 1)}});
    return;
  }
  if (std::abs(reach - length) <= kLikeLength * length) return;
  out.warn("line-stations",
           name + ": the stations span " + format_brief(reach) + " m, and the line is " +
               format_brief(length) +
               " m long, so they may be in another unit; each pose has the station that lies "
               "evenly between those of its vertices",
           {{"stations", reach}, {"length", length}});
}

void remark_slopes(const std::string& name, const LineVertices& line,
                   const std::vector<PlanPoint>& vertices, Remarks& out) {
  constexpr double kSteep = 0.3;
  std::size_t steepest = 0;
  double most = 0;
  for (std::size_t i = 0; i + 1 < line.z.size(); ++i) {
    const double slope =
        std::abs((line.z[i + 1] - line.z[i]) / std::abs(vertices[i + 1] - vertices[i]));
    if (slope > most) steepest = i;
    most = std::max(most, slope);
  }
  if (!(most > kSteep)) return;
  out.warn("line-steep",
           name + ": the line climbs or falls by " + format_brief(100 * most) + " % after " +
               vertex_text(line, steepest) + " (" + line.place_of(steepest) +
               "), which is steep for a vehicle; make sure that z is the height",
           {{"percent", 100 * most}});
}

/// Refuses a line whose curve would be no more than a guess, because it turns too much at a vertex.
void check_turns(const std::string& name, const LineVertices& line,
                 const std::vector<PlanPoint>& vertices) {
  std::size_t first = 0, count = 0;
  for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
    if (!(std::abs(turn_at(vertices, i)) > kMostLineTurn * kDegree * (1 + 1e-12))) continue;
    if (count++ == 0) first = i;
  }
  if (count == 0) return;
  const std::string others =
      count == 1 ? "" : ", and " + counted(count - 1, "other vertex", "other vertices") + " too";
  refuse(name,
         line.place_of(first) + ": the line turns by " +
             format_brief(std::abs(turn_at(vertices, first)) / kDegree) + " degrees at " +
             vertex_text(line, first) + others + "; expected at most " +
             format_brief(kMostLineTurn) +
             ", because a smooth curve through sharper corners leaves the line",
         Remedy::kRoundCorners);
}

/// Refuses a line on whose legs the arcs do not fit.
void check_arcs(const std::string& name, const LineVertices& line,
                const std::vector<PlanPoint>& vertices, double radius) {
  const std::vector<ShortLeg> found = short_legs(vertices, radius);
  if (found.empty()) return;
  const ShortLeg& leg = found.front();
  // The vertex whose arc takes the larger part of the leg.
  const auto turn = [&](std::size_t i) {
    return i == 0 || i + 1 == vertices.size() ? 0 : std::abs(turn_at(vertices, i));
  };
  const std::size_t vertex = turn(leg.from) > turn(leg.from + 1) ? leg.from : leg.from + 1;
  const double fits = largest_radius(vertices);
  const std::string advice =
      fits >= 0.001
          ? ". A radius of " + format_brief(std::floor(1000 * fits) / 1000) + " m fits everywhere"
          : ". The line turns back there, which no arc rounds";
  const std::string others =
      found.size() == 1 ? "" : ", and " + counted(found.size() - 1, "other leg") + " too";
  refuse(name, line.place_of(vertex) + ": the leg from vertex " + std::to_string(leg.from + 1) +
                   " to vertex " + std::to_string(leg.from + 2) + " is " +
                   format_brief(leg.length) + " m long, which is too short for arcs of radius " +
                   format_brief(radius) + " m: that at " + vertex_text(line, vertex) +
                   ", where the line turns by " + format_brief(turn(vertex) / kDegree) +
                   " degrees, and its neighbour's need " + format_brief(leg.needed) + " m of it" +
                   others + advice);
}

/// Remarks on how far a path with rounded corners passes from the vertices.
void remark_arcs(const std::string& name, const LineVertices& line,
                 const std::vector<PlanPoint>& vertices, double radius, LineFile& out) {
  double most = 0;
  std::size_t at = 0;
  for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
    const double turn = std::abs(turn_at(vertices, i));
    if (!(turn > 0)) continue;
    ++out.arcs;
    const double cut = radius * (1 / std::cos(turn / 2) - 1);
    if (cut > most) at = i;
    most = std::max(most, cut);
  }
  if (out.arcs == 0) return;
  out.note("line-rounded",
           name + ": " + counted(out.arcs, "vertex", "vertices") + " got an arc of radius " +
               format_brief(radius) + " m, which passes " + vertex_text(line, at) + " " +
               format_brief(most) + " m to its inside, the most of all",
           {{"arcs", static_cast<double>(out.arcs)}, {"metres", most}});
}

/// Remarks on how far the curve through the vertices leaves the straight legs between them.
void remark_curve(const std::string& name, const LineVertices& line,
                  const std::vector<PlanPoint>& vertices, const LinePath& path, Remarks& out) {
  constexpr double kNoted = 0.01, kWarned = 0.1;
  const auto* heights = std::get_if<HeightCurve>(&path.height);
  const auto turn = [&](std::size_t i) {
    return i == 0 || i + 1 == vertices.size() ? 0 : std::abs(turn_at(vertices, i));
  };
  double aside = 0, above = 0;
  std::size_t at = 0;
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    const PlanPoint leg = vertices[i + 1] - vertices[i];
    const bool bends = std::abs(leg) * (turn(i) + turn(i + 1)) > kNoted;
    const double from = path.plan.station_of(i), to = path.plan.station_of(i + 1);
    for (const double share : {0.25, 0.5, 0.75}) {
      const double station = from + share * (to - from);
      const double before = std::max(aside, above);
      if (bends) {
        const PlanPoint away = (path.plan.at(station).at - vertices[i]) * std::conj(leg);
        aside = std::max(aside, std::abs(away.imag()) / std::abs(leg));
      }
      if (heights != nullptr) {
        const double straight = line.z[i] + share * (line.z[i + 1] - line.z[i]);
        above = std::max(above, std::abs(heights->at(station).value - straight));
      }
      if (std::max(aside, above) > before) at = i;
    }
  }
  const double most = std::max(aside, above);
  if (!(most > kNoted)) return;
  const std::string text =
      name + ": between its vertices the path is a smooth curve, which is up to " +
      format_brief(aside) + " m beside the straight legs and " + format_brief(above) +
      " m above or below them, the most after " + vertex_text(line, at) + " (" + line.place_of(at) +
      "). More vertices keep it closer";
  out.warn_or_note(most > kWarned, "line-curved", text, {{"aside", aside}, {"above", above}});
}

LinePlan plan_of(const std::string& name, const LineVertices& line,
                 const std::vector<PlanPoint>& vertices, const LineOptions& options) {
  if (!options.corner_radius) {
    check_turns(name, line, vertices);
    return LinePlan::through(vertices);
  }
  check_arcs(name, line, vertices, *options.corner_radius);
  return LinePlan::rounded(vertices, *options.corner_radius);
}

std::vector<double> vertex_stations(const LinePlan& plan, std::size_t vertices) {
  std::vector<double> stations;
  for (std::size_t i = 0; i < vertices; ++i) stations.push_back(plan.station_of(i));
  return stations;
}

void set_heights(const std::string& name, const LineVertices& line, const LineOptions& options,
                 LinePath& path) {
  if (!line.z.empty() && options.height) {
    throw UsageError(name +
                     ": the vertices have heights; expected a height of the whole line only "
                     "without them");
  }
  if (line.z.empty() && options.ground != nullptr) return;
  if (line.z.empty() && !options.height) {
    refuse(name, "the vertices have no heights", Remedy::kGiveHeight);
  }
  if (line.z.empty()) {
    path.height.emplace<double>(*options.height);
  } else if (options.corner_radius) {
    path.height.emplace<AlignmentProfile>(
        rounded_profile(path.plan, line.z, *options.corner_radius));
  } else {
    path.height.emplace<HeightCurve>(vertex_stations(path.plan, line.size()), line.z);
  }
}

void set_cant(const std::string& name, const LineVertices& line, const LineOptions& options,
              LinePath& path, Remarks& out) {
  const bool asked = options.rail_distance ||
                     (options.cant != CantLine::kCenter && options.cant != CantLine::kFile);
  if (line.cant.empty()) {
    if (asked) {
      out.note("no-cant", name + ": the line has no cant, so options of cant change nothing");
    }
    return;
  }
  if (options.cant == CantLine::kNone) return;
  if (!options.rail_distance) {
    out.note("cant-rails",
             name +
                 ": the cant was measured over a distance of 1.5 m between the middles of the "
                 "rails, as on standard gauge",
             {{"metres", kUsualRails}});
  }
  path.rail_distance = options.rail_distance.value_or(kUsualRails);
  path.cant_line = options.cant == CantLine::kFile ? CantLine::kCenter : options.cant;
  std::vector<CantPoint> points;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (!(std::abs(line.cant[i]) < path.rail_distance)) {
      refuse(name, line.place_of(i) + ": a cant of " + format_digits(line.cant[i], 9) +
                       " m; expected less than the distance between the rails, " +
                       format_digits(path.rail_distance, 9) + " m");
    }
    points.push_back({path.plan.station_of(i), line.cant[i]});
  }
  path.cant.emplace(std::move(points));
}

/// The stations of a file at the places of a path, evenly between those of its vertices.
std::vector<double> stations_at(const LineVertices& line, const LinePlan& plan,
                                const std::vector<double>& places) {
  std::vector<double> stations;
  if (line.station.empty()) return stations;
  std::size_t leg = 0;
  for (const double place : places) {
    while (leg + 2 < line.size() && place >= plan.station_of(leg + 1)) ++leg;
    const double from = plan.station_of(leg), to = plan.station_of(leg + 1);
    const double share = std::clamp((place - from) / (to - from), 0.0, 1.0);
    const double before = line.station[leg], after = line.station[leg + 1];
    stations.push_back(share == 1 ? after : before + share * (after - before));
  }
  return stations;
}

/// The options, in which the store of the ground counts as the environment.
LineOptions with_environment(LineOptions options) {
  if (options.ground == nullptr) return options;
  const Store& store = *options.ground;
  if (store.length_unit() == "degree") {
    throw UsageError(store.path().string() +
                     ": the coordinates are degrees, so no ground can be found; expected a store "
                     "with coordinates that are lengths");
  }
  options.environment_unit = store.metres_per_unit();
  options.environment_unit_is_assumed = store.length_unit() == "unknown";
  options.environment_crs = store.crs_wkt();
  return options;
}

}  // namespace

LineFile read_line_file(const std::filesystem::path& path, const LineOptions& given) {
  check_options(given);
  const LineOptions options = with_environment(given);
  const std::string name = path.string();
  LineFile out;
  const LineVertices line = read_line_vertices(path, options, out);
  std::vector<PlanPoint> vertices;
  for (std::size_t i = 0; i < line.size(); ++i) vertices.emplace_back(line.x[i], line.y[i]);
  check_degrees(name, line, out);
  LinePath along{.plan = plan_of(name, line, vertices, options), .height = 0.0};
  set_heights(name, line, options, along);
  remark_unit(name, line, options, out);
  remark_crs(name, line, options, out);
  remark_stations(name, line, vertices, out);
  remark_slopes(name, line, vertices, out);
  if (options.corner_radius) {
    remark_arcs(name, line, vertices, *options.corner_radius, out);
  } else {
    remark_curve(name, line, vertices, along, out);
  }
  Reach reach{0, along.plan.length()};
  if (options.ground != nullptr) {
    reach = put_on_ground(name, line, options, along, out);
  } else {
    set_cant(name, line, options, along, out);
  }
  const std::vector<double> places = even_stations(reach.from, reach.to, options.step);
  for (const double place : places) out.poses.push_back(along.pose_at(place));
  const bool is_given = along.cant && options.ground == nullptr;
  if (is_given) remark_cant(name, *along.cant, along.rail_distance, out.poses, out);
  out.stations = stations_at(line, along.plan, places);
  if (options.reverse) turn_round(out.poses, out.stations);
  out.format = line.format;
  out.vertices = line.size();
  out.length = along.plan.length();
  out.metres_per_unit = line.metres_per_unit;
  return out;
}

std::vector<Pose> read_line(const std::filesystem::path& path, const LineOptions& options,
                            std::vector<Message>* remarks, PoseLabels* labels) {
  return read_line_file(path, options).hand_over(remarks, labels);
}

}  // namespace clearway
