#include "io/paths/line/line_file.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/store.hpp"
#include "core/geometry/angle.hpp"
#include "core/trajectory/line/line_path.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/util/format.hpp"
#include "io/paths/line/line_ground.hpp"
#include "io/paths/line/line_vertices.hpp"
#include "io/paths/poses_along.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {
namespace {

void check_options(const LineOptions& options) {
  const auto above_0 = [](const std::optional<double>& value, const char* option) {
    check_option(value, option, value > 0.0, "a length above 0");
  };
  above_0(options.step, "step");
  above_0(options.corner_radius, "corner radius");
  above_0(options.rail_distance, "rail distance");
  check_option(options.height, "height", true, "a finite height");
  above_0(options.track, "track");
  if ((options.ground != nullptr) != options.track.has_value()) {
    throw UsageError(
        "the ground gives height and roll only together with the track, the distance between the "
        "left and the right wheels; expected both or neither");
  }
}

/// The greatest size of values in a range.
double greatest_of(const std::ranges::minmax_result<double>& range) {
  return std::max(std::abs(range.min), std::abs(range.max));
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

/// Makes the poses along a line, and judges its file.
class LineReading {
 public:
  LineReading(const std::filesystem::path& path, const LineOptions& options)
      : name_(path.string()), options_(options), line_(read_line_vertices(path, options, out_)) {
    for (std::size_t i = 0; i < line_.size(); ++i) vertices_.emplace_back(line_.x[i], line_.y[i]);
  }

  LineFile read() {
    check_degrees();
    LinePath along{.plan = plan_of(), .height = 0.0};
    set_heights(along);
    remark_unit();
    remark_crs();
    remark_stations();
    remark_slopes();
    if (options_.corner_radius) {
      remark_arcs(*options_.corner_radius);
    } else {
      remark_curve(along);
    }
    Reach reach{0, along.plan.length()};
    if (options_.ground != nullptr) {
      reach = put_on_ground(name_, line_, options_, along, out_);
    } else {
      set_cant(along);
    }
    const std::vector<double> places = even_stations(reach.from, reach.to, options_.step);
    for (const double place : places) out_.poses.push_back(along.pose_at(place));
    const bool is_given = along.cant && options_.ground == nullptr;
    if (is_given) remark_cant(name_, *along.cant, along.rail_distance, out_.poses, out_);
    out_.stations = stations_at(along.plan, places);
    if (options_.reverse) turn_round(out_.poses, out_.stations);
    out_.format = line_.format;
    out_.vertices = line_.size();
    out_.length = along.plan.length();
    out_.metres_per_unit = line_.metres_per_unit;
    return std::move(out_);
  }

 private:
  /// A vertex in words: "vertex 3 at 512.25 77.1".
  std::string vertex_text(std::size_t vertex) const {
    return "vertex " + std::to_string(vertex + 1) + " at " + format_digits(line_.x[vertex], 9) +
           " " + format_digits(line_.y[vertex], 9);
  }

  /// How far the line turns at a vertex to either side, in radians.
  double turn(std::size_t i) const {
    return i == 0 || i + 1 == vertices_.size() ? 0 : std::abs(turn_at(vertices_, i));
  }

  /// Refuses coordinates that are longitude and latitude by their size, or warns of them. A path of
  /// less than half a metre makes no sense, and one of more than 5 degrees leads through countries.
  void check_degrees() {
    constexpr double kSurely = 0.5, kMaybe = 5;
    if (line_.unit.is_known()) return;
    const auto x = std::ranges::minmax(line_.x), y = std::ranges::minmax(line_.y);
    const double unit = line_.metres_per_unit;
    const bool on_globe = greatest_of(x) <= 180 * unit && greatest_of(y) <= 90 * unit;
    const double extent = std::max(x.max - x.min, y.max - y.min) / unit;
    if (!on_globe || extent > kMaybe) return;
    const std::string text =
        "the coordinates reach from " + format_digits(x.min / unit, 9) + " " +
        format_digits(y.min / unit, 9) + " to " + format_digits(x.max / unit, 9) + " " +
        format_digits(y.max / unit, 9) +
        (extent > kSurely
             ? ", which may be longitude and latitude"
             : ", which are longitude and latitude or a line of less than half a metre");
    const std::string advice =
        "; the system of the scan is expected, so transform degrees to it first, for example with "
        "ogr2ogr -t_srs or in a GIS";
    if (extent <= kSurely) {
      refuse(name_, text + advice + ". Where they are lengths, their unit has to be named",
             Remedy::kDeclareLength);
    }
    out_.warn("line-degrees", name_ + ": " + text + advice, {{"extent", extent}});
  }

  void remark_unit() {
    const double metres = line_.metres_per_unit;
    if (line_.unit.is_known() && metres != 1 && options_.environment_unit_is_assumed) {
      out_.warn("unit-assumed", unit_assumed_text(name_ + ": its coordinates", metres),
                {{"metres", metres}});
    }
    if (metres != 1) {
      out_.note("trajectory-unit", {{"metres", metres}},
                "{}: positions were multiplied by {} to give metres", name_,
                format_digits(metres, 9));
    }
    if (!is_foot(metres) || !is_foot(options_.environment_unit)) return;
    const double largest = std::max(greatest_of(std::ranges::minmax(line_.x)),
                                    greatest_of(std::ranges::minmax(line_.y)));
    const double moved = feet_apart(largest, metres, options_.environment_unit);
    if (metres == options_.environment_unit || !(moved > kFeetApart)) return;
    out_.warn("two-feet",
              two_feet_text(name_ + ": its positions", metres, options_.environment_unit, moved),
              {{"metres", moved}});
  }

  void remark_crs() {
    if (const auto other = other_epsg(line_.epsg, options_.environment_crs)) {
      out_.warn("line-crs", other_crs_text(name_, line_.epsg, *other, "line"),
                {{"line", line_.epsg}, {"environment", *other}});
    }
  }

  void remark_stations() {
    if (line_.station.empty()) return;
    const std::vector<double>& stations = line_.station;
    constexpr double kLikeLength = 0.05;
    double length = 0;  // in metres, of the legs together in plan
    for (std::size_t i = 1; i < vertices_.size(); ++i) {
      length += std::abs(vertices_[i] - vertices_[i - 1]);
    }
    const double reach = std::abs(stations.back() - stations.front());
    const bool ascends = stations.back() >= stations.front();
    for (std::size_t i = 1; i < stations.size(); ++i) {
      if (stations[i] != stations[i - 1] && (stations[i] > stations[i - 1]) == ascends) continue;
      out_.warn(
          "station-order", {{"vertex", i + 1}},
          "{}: {}: the station {} m comes after {} m, so stations do not run evenly along the line",
          name_, line_.place_of(i), format_digits(stations[i], 9),
          format_digits(stations[i - 1], 9));
      return;
    }
    if (std::abs(reach - length) <= kLikeLength * length) return;
    out_.warn("line-stations", {{"stations", reach}, {"length", length}},
              "{}: the stations span {} m, and the line is {} m long, so they may be in another "
              "unit; each pose has the station that lies evenly between those of its vertices",
              name_, format_brief(reach), format_brief(length));
  }

  void remark_slopes() {
    constexpr double kSteep = 0.3;
    std::size_t steepest = 0;
    double most = 0;
    for (std::size_t i = 0; i + 1 < line_.z.size(); ++i) {
      const double slope =
          std::abs((line_.z[i + 1] - line_.z[i]) / std::abs(vertices_[i + 1] - vertices_[i]));
      if (slope > most) steepest = i;
      most = std::max(most, slope);
    }
    if (!(most > kSteep)) return;
    out_.warn("line-steep", {{"percent", 100 * most}},
              "{}: the line climbs or falls by {} % after {} ({}), which is steep for a vehicle; "
              "make sure that z is the height",
              name_, format_brief(100 * most), vertex_text(steepest), line_.place_of(steepest));
  }

  /// Refuses a line whose curve would be no more than a guess, because it turns too much at a
  /// vertex.
  void check_turns() {
    std::size_t first = 0, count = 0;
    for (std::size_t i = 1; i + 1 < vertices_.size(); ++i) {
      if (!(turn(i) > kMostLineTurn * kDegree * (1 + 1e-12))) continue;
      if (count++ == 0) first = i;
    }
    if (count == 0) return;
    const std::string others =
        count == 1 ? "" : ", and " + counted(count - 1, "other vertex", "other vertices") + " too";
    refuse(name_, Remedy::kRoundCorners,
           "{}: the line turns by {} degrees at {}{}; expected at most {}, because a smooth curve "
           "through sharper corners leaves the line",
           line_.place_of(first), format_brief(turn(first) / kDegree), vertex_text(first), others,
           format_brief(kMostLineTurn));
  }

  /// Refuses a line on whose legs the arcs do not fit.
  void check_arcs(double radius) {
    const std::vector<ShortLeg> found = short_legs(vertices_, radius);
    if (found.empty()) return;
    const ShortLeg& leg = found.front();
    // The vertex whose arc takes the larger part of the leg.
    const std::size_t vertex = turn(leg.from) > turn(leg.from + 1) ? leg.from : leg.from + 1;
    const double fits = largest_radius(vertices_);
    const std::string advice =
        fits >= 0.001
            ? ". A radius of " + format_brief(std::floor(1000 * fits) / 1000) + " m fits everywhere"
            : ". The line turns back there, which no arc rounds";
    const std::string others =
        found.size() == 1 ? "" : ", and " + counted(found.size() - 1, "other leg") + " too";
    refuse(name_, line_.place_of(vertex) + ": the leg from vertex " + std::to_string(leg.from + 1) +
                      " to vertex " + std::to_string(leg.from + 2) + " is " +
                      format_brief(leg.length) + " m long, which is too short for arcs of radius " +
                      format_brief(radius) + " m: that at " + vertex_text(vertex) +
                      ", where the line turns by " + format_brief(turn(vertex) / kDegree) +
                      " degrees, and its neighbour's need " + format_brief(leg.needed) +
                      " m of it" + others + advice);
  }

  /// Remarks on how far a path with rounded corners passes from the vertices_.
  void remark_arcs(double radius) {
    double most = 0;
    std::size_t at = 0;
    for (std::size_t i = 1; i + 1 < vertices_.size(); ++i) {
      if (!(turn(i) > 0)) continue;
      ++out_.arcs;
      const double cut = radius * (1 / std::cos(turn(i) / 2) - 1);
      if (cut > most) at = i;
      most = std::max(most, cut);
    }
    if (out_.arcs == 0) return;
    out_.note("line-rounded",
              name_ + ": " + counted(out_.arcs, "vertex", "vertices") + " got an arc of radius " +
                  format_brief(radius) + " m, which passes " + vertex_text(at) + " " +
                  format_brief(most) + " m to its inside, the most of all",
              {{"arcs", out_.arcs}, {"metres", most}});
  }

  /// Remarks on how far the curve through the vertices leaves the straight legs between them.
  void remark_curve(const LinePath& path) {
    constexpr double kNoted = 0.01, kWarned = 0.1;
    const auto* heights = std::get_if<HeightCurve>(&path.height);
    double aside = 0, above = 0;
    std::size_t at = 0;
    for (std::size_t i = 0; i + 1 < vertices_.size(); ++i) {
      const PlanPoint leg = vertices_[i + 1] - vertices_[i];
      const bool bends = std::abs(leg) * (turn(i) + turn(i + 1)) > kNoted;
      const double from = path.plan.station_of(i), to = path.plan.station_of(i + 1);
      for (const double share : {0.25, 0.5, 0.75}) {
        const double station = from + share * (to - from);
        const double before = std::max(aside, above);
        if (bends) {
          const PlanPoint away = (path.plan.at(station).at - vertices_[i]) * std::conj(leg);
          aside = std::max(aside, std::abs(away.imag()) / std::abs(leg));
        }
        if (heights != nullptr) {
          const double straight = line_.z[i] + share * (line_.z[i + 1] - line_.z[i]);
          above = std::max(above, std::abs(heights->at(station).value - straight));
        }
        if (std::max(aside, above) > before) at = i;
      }
    }
    const double most = std::max(aside, above);
    if (!(most > kNoted)) return;
    const std::string text =
        name_ + ": between its vertices the path is a smooth curve, which is up to " +
        format_brief(aside) + " m beside the straight legs and " + format_brief(above) +
        " m above or below them, the most after " + vertex_text(at) + " (" + line_.place_of(at) +
        "). More vertices keep it closer";
    out_.warn_or_note(most > kWarned, "line-curved", text, {{"aside", aside}, {"above", above}});
  }

  LinePlan plan_of() {
    if (!options_.corner_radius) {
      check_turns();
      return LinePlan::through(vertices_);
    }
    check_arcs(*options_.corner_radius);
    return LinePlan::rounded(vertices_, *options_.corner_radius);
  }

  std::vector<double> vertex_stations(const LinePlan& plan) const {
    std::vector<double> stations;
    for (std::size_t i = 0; i < line_.size(); ++i) stations.push_back(plan.station_of(i));
    return stations;
  }

  void set_heights(LinePath& path) {
    if (!line_.z.empty() && options_.height) {
      throw UsageError(name_ +
                       ": the vertices have heights; expected a height of the whole line only "
                       "without them");
    }
    if (line_.z.empty() && options_.ground != nullptr) return;
    if (line_.z.empty() && !options_.height) {
      refuse(name_, "the vertices have no heights", Remedy::kGiveHeight);
    }
    if (line_.z.empty()) {
      path.height.emplace<double>(*options_.height);
    } else if (options_.corner_radius) {
      path.height.emplace<AlignmentProfile>(
          rounded_profile(path.plan, line_.z, *options_.corner_radius));
    } else {
      path.height.emplace<HeightCurve>(vertex_stations(path.plan), line_.z);
    }
  }

  void set_cant(LinePath& path) {
    const bool asked = options_.rail_distance ||
                       (options_.cant != CantLine::kCenter && options_.cant != CantLine::kFile);
    if (line_.cant.empty()) {
      if (asked) {
        out_.note("no-cant", name_ + ": the line has no cant, so options of cant change nothing");
      }
      return;
    }
    if (options_.cant == CantLine::kNone) return;
    if (!options_.rail_distance) {
      out_.note("cant-rails", {{"metres", kUsualRails}},
                "{}: the cant was measured over a distance of 1.5 m between the middles of the "
                "rails, as on standard gauge",
                name_);
    }
    path.rail_distance = options_.rail_distance.value_or(kUsualRails);
    path.cant_line = options_.cant == CantLine::kFile ? CantLine::kCenter : options_.cant;
    std::vector<CantPoint> points;
    for (std::size_t i = 0; i < line_.size(); ++i) {
      if (!(std::abs(line_.cant[i]) < path.rail_distance)) {
        refuse(name_, line_.place_of(i) + ": a cant of " + format_digits(line_.cant[i], 9) +
                          " m; expected less than the distance between the rails, " +
                          format_digits(path.rail_distance, 9) + " m");
      }
      points.push_back({path.plan.station_of(i), line_.cant[i]});
    }
    path.cant.emplace(std::move(points));
  }

  /// The stations of a file at the places of a path, evenly between those of its vertices.
  std::vector<double> stations_at(const LinePlan& plan, const std::vector<double>& places) const {
    std::vector<double> stations;
    if (line_.station.empty()) return stations;
    std::size_t leg = 0;
    for (const double place : places) {
      while (leg + 2 < line_.size() && place >= plan.station_of(leg + 1)) ++leg;
      const double from = plan.station_of(leg), to = plan.station_of(leg + 1);
      const double share = std::clamp((place - from) / (to - from), 0.0, 1.0);
      const double before = line_.station[leg], after = line_.station[leg + 1];
      stations.push_back(share == 1 ? after : before + share * (after - before));
    }
    return stations;
  }

  std::string name_;
  const LineOptions& options_;
  LineFile out_;
  LineVertices line_;
  std::vector<PlanPoint> vertices_;
};

}  // namespace

LineFile read_line_file(const std::filesystem::path& path, const LineOptions& given) {
  check_options(given);
  const LineOptions options = with_environment(given);
  return LineReading(path, options).read();
}

std::vector<Pose> read_line(const std::filesystem::path& path, const LineOptions& options,
                            std::vector<Message>* remarks, PoseLabels* labels) {
  return read_line_file(path, options).hand_over(remarks, labels);
}

}  // namespace clearway
