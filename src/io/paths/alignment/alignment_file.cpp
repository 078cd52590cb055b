#include "io/paths/alignment/alignment_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/paths/alignment/alignment_parts.hpp"
#include "io/paths/alignment/land_xml.hpp"
#include "io/paths/poses_along.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {
namespace {

void check_options(const AlignmentOptions& options) {
  check_option(options.step, "--step", options.step > 0, "a length above 0");
  check_option(options.max_gap, "--max-gap", options.max_gap >= 0, "a length of 0 or more");
  check_option(options.rail_distance, "--rail-distance", options.rail_distance.value_or(1) > 0,
               "a length above 0");
  check_option(options.station_from, "--from", true, "a finite station");
  check_option(options.station_to, "--to", true, "a finite station");
  check_option(options.height, "--height", true, "a finite height");
  if (options.station_from && options.station_to && *options.station_from > *options.station_to) {
    throw UsageError("--from " + format_digits(*options.station_from, 9) + " is after --to " +
                     format_digits(*options.station_to, 9) +
                     "; expected ascending stations, and --reverse to travel against them");
  }
}

pugi::xml_node choose_alignment(const LandXml& xml, const AlignmentOptions& options) {
  std::vector<pugi::xml_node> nodes;
  for (const pugi::xml_node list : xml.root().children("Alignments")) {
    for (const pugi::xml_node node : list.children("Alignment")) nodes.push_back(node);
  }
  if (nodes.empty()) refuse(xml.name(), "holds no Alignment; expected one in its Alignments");
  return choose_by_name(xml, nodes, options.alignment, "alignment", "--alignment");
}

/// A station that was asked for, which the plan has to reach.
double asked_station(const LandXml& xml, const AlignmentPlan& plan, double station,
                     const char* option) {
  const double metres = xml.in_metres(station);
  const double first = plan.first_station(), last = plan.last_station();
  if (metres < first - kSameStation || metres > last + kSameStation) {
    throw UsageError(xml.name() + ": " + option + " " + format_digits(station, 9) +
                     " is off the alignment; expected a station from " + xml.unit_text(first) +
                     " to " + xml.unit_text(last));
  }
  return std::clamp(metres, first, last);
}

/// Shortens the reach to that of the profile.
void clip_to_profile(const LandXml& xml, const AlignmentProfile& profile, Reach& reach,
                     AlignmentFile& out) {
  constexpr double kWorthTelling = 0.001;
  const Reach asked = reach;
  // A station just beyond the profile counts as its end.
  const auto within = [&](double station) {
    const double end = std::clamp(station, profile.first_station(), profile.last_station());
    return std::abs(station - end) <= kSameStation;
  };
  if (reach.from == reach.to && within(reach.from)) return;
  reach = {std::max(reach.from, profile.first_station()),
           std::min(reach.to, profile.last_station())};
  const std::string has = "the profile has heights from station " +
                          xml.unit_text(profile.first_station()) + " to " +
                          xml.unit_text(profile.last_station()) + " only";
  if (reach.from > reach.to) refuse(xml.name(), has + ", where no pose is wanted");
  const double begins = reach.from - asked.from, ends = asked.to - reach.to;
  const std::string later =
      begins > kWorthTelling ? "begin " + format_brief(begins) + " m later" : std::string();
  const std::string earlier =
      ends > kWorthTelling ? "end " + format_brief(ends) + " m earlier" : std::string();
  if (later.empty() && earlier.empty()) return;
  out.warn("profile-shorter",
           fmt::format("{}: {}, so the poses {}{}{} than what was wanted of the plan", xml.name(),
                       has, later, later.empty() || earlier.empty() ? "" : " and ", earlier),
           {{"first", xml.in_units(profile.first_station())},
            {"last", xml.in_units(profile.last_station())},
            {"begins_after", begins},
            {"ends_before", ends}});
}

void remark_cant_ends(const LandXml& xml, const Alignment& track, const Reach& reach,
                      AlignmentFile& out) {
  if (!track.cant) return;
  const CantPoint &begin = track.cant->points().front(), &end = track.cant->points().back();
  const double first = begin.station, last = end.station;
  const bool early = reach.from + kSameStation < first;
  const bool late = reach.to - kSameStation > last;
  // Beyond an end without cant the track is level, as is usual.
  const bool canted = (early && begin.cant != 0) || (late && end.cant != 0);
  if (!canted) return;
  const std::string text = xml.name() + ": the cant is given from station " + xml.unit_text(first) +
                           " to " + xml.unit_text(last) +
                           " only; beyond its ends the last value was kept, which is not 0";
  out.warn("cant-ends", text, {{"first", xml.in_units(first)}, {"last", xml.in_units(last)}});
}

/// Warns where it matters which foot the file means.
void remark_feet(const LandXml& xml, const AlignmentPlan& plan, AlignmentFile& out) {
  const double unit = xml.metres_per_unit();
  if (!is_foot(unit)) return;
  double largest = 0;
  for (const PlanElement& element : plan.elements()) {
    largest = std::max({largest, std::abs(element.start.real()), std::abs(element.start.imag())});
  }
  const double other = unit == kMetresPerFoot ? kMetresPerUsSurveyFoot : kMetresPerFoot;
  const double moved = feet_apart(largest, unit, other);
  if (!(moved > kFeetApart)) return;
  out.warn("alignment-feet", {{"metres", moved}},
           "{}: the coordinates are in {}, up to {}; in {} they would be {} m elsewhere, so make "
           "sure that the scan and the file mean the same foot",
           xml.name(), units_text(unit), xml.unit_text(largest), units_text(other),
           format_brief(moved));
}

/// The EPSG code of a CoordinateSystem; 0 where it names none.
long epsg_of(const LandXml& xml, pugi::xml_node system) {
  for (const char* name : {"epsgCode", "horizontalDatum"}) {
    std::string_view text = xml.attribute(system, name).value_or("");
    if (text.starts_with("EPSG:")) text.remove_prefix(5);
    const auto code = whole_number_of<double>(text);
    if (code && *code >= 1 && *code <= 99'999'999 && std::floor(*code) == *code) {
      return static_cast<long>(*code);
    }
  }
  return 0;
}

void remark_crs(const LandXml& xml, const std::string& environment, AlignmentFile& out) {
  long code = 0;
  for (const pugi::xml_node system : xml.root().children("CoordinateSystem")) {
    const long found = epsg_of(xml, system);
    if (code != 0 && found != 0 && found != code) {
      out.warn("alignment-crs", {{"alignment", code}, {"other", found}},
               "{}: names two coordinate systems, EPSG:{} and EPSG:{}; the coordinates were not "
               "converted, so make sure that they are in that of the environment",
               xml.name(), code, found);
      return;
    }
    if (code == 0) code = found;
  }
  if (const auto other = other_epsg(code, environment)) {
    out.warn("alignment-crs", other_crs_text(xml.name(), code, *other, "alignment"),
             {{"alignment", code}, {"environment", *other}});
  }
}

void add_poses(const LandXml& xml, const Alignment& track, AlignmentFile& out) {
  out.poses.reserve(out.stations.size());
  for (const double station : out.stations) {
    const Pose pose = track.pose_at(station);
    double sum = 0;
    for (const double number : pose.rotation) sum += number;
    for (const double number : pose.translation) sum += number;
    if (!std::isfinite(sum)) {
      refuse(xml.name(), "gives no finite pose at station " + xml.unit_text(station) +
                             "; its lengths or heights are too large");
    }
    out.poses.push_back(pose);
  }
}

/// The alignment without its cant.
Alignment read_track(const LandXml& xml, pugi::xml_node node, const AlignmentOptions& options,
                     AlignmentFile& out) {
  Alignment track{.plan = read_plan(xml, node, options.max_gap, out),
                  .profile = read_profile(xml, node, options, out)};
  if (track.profile && options.height) {
    throw UsageError(
        "--height: the alignment has a profile, which gives its heights; expected "
        "--height only without one");
  }
  if (!track.profile && !options.height) {
    refuse(xml.name(),
           "the alignment has no profile, so its heights are not known; --height gives "
           "one for all of it");
  }
  track.level = options.height.value_or(0);
  return track;
}

}  // namespace

AlignmentFile read_alignment_file(const std::filesystem::path& path,
                                  const AlignmentOptions& options) {
  check_options(options);
  const LandXml xml(path, options.order);
  const pugi::xml_node node = choose_alignment(xml, options);
  AlignmentFile out;
  out.alignment = xml.name_of(node);
  out.unit = xml.unit_name();
  out.metres_per_unit = xml.metres_per_unit();
  Alignment track = read_track(xml, node, options, out);
  read_cant(xml, node, options, track, out);
  Reach reach{track.plan.first_station(), track.plan.last_station()};
  out.first_station = reach.from;
  out.last_station = reach.to;
  if (options.station_from) {
    reach.from = asked_station(xml, track.plan, *options.station_from, "--from");
  }
  if (options.station_to) reach.to = asked_station(xml, track.plan, *options.station_to, "--to");
  if (track.profile) clip_to_profile(xml, *track.profile, reach, out);
  remark_cant_ends(xml, track, reach, out);
  remark_left_out(xml, node, out);
  remark_feet(xml, track.plan, out);
  remark_crs(xml, options.environment_crs, out);
  out.stations = even_stations(reach.from, reach.to, options.step);
  add_poses(xml, track, out);
  if (track.cant) remark_cant(xml.name(), *track.cant, track.rail_distance, out.poses, out);
  if (options.reverse) turn_round(out.poses, out.stations);
  return out;
}

std::vector<Pose> read_alignment(const std::filesystem::path& path, const AlignmentOptions& options,
                                 std::vector<Message>* remarks, PoseLabels* labels) {
  return read_alignment_file(path, options).hand_over(remarks, labels);
}

}  // namespace clearway
