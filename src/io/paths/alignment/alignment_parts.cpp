#include "io/paths/alignment/alignment_parts.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/util/format.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway {
namespace {

using Complex = std::complex<double>;

/// Metres by which a declared length or station may differ from the computed one without a warning.
constexpr double kDeclared = 0.001;
/// Radians by which the direction may change between two elements without a warning.
constexpr double kKink = 1e-3;

/// A length for a message, rounded to a micrometre unless it is smaller.
std::string metres_text(double metres) {
  return std::abs(metres) < 1e-6 ? format_brief(metres)
                                 : format_number(std::round(metres * 1e6) / 1e6);
}

double cross(Complex a, Complex b) { return a.real() * b.imag() - a.imag() * b.real(); }

constexpr NamedValue<double> kSenses[] = {{"cw", -1}, {"ccw", 1}};  // 1 to the left

/// At how many places a limit is exceeded, by how much at most, and the station there.
struct Excess {
  std::size_t places = 0;
  double most = 0, station = 0;

  void add(double value, double limit, double at) {
    if (!(value > limit)) return;
    ++places;
    if (value > most) station = at;
    most = std::max(most, value);
  }
};

/// An element of a plan and the node that describes it.
struct PlanPart {
  pugi::xml_node node;
  PlanElement element;
  /// Whether it is an arc whose length follows from its centre and its sense
  bool arc_found = false;
};

void check_turn(const LandXml& xml, pugi::xml_node node, const PlanElement& element) {
  const double turn = std::abs(element.turn());
  if (turn < 2 * std::numbers::pi) return;
  xml.refuse_at(node, "turns by " + format_digits(turn * 180 / std::numbers::pi, 9) +
                          " degrees; expected less than a full circle, as closed curves are not "
                          "read");
}

/// Refuses a centre that lies on the other side of the chord than the curve's sense and length say,
/// as with swapped coordinates.
void check_center(const LandXml& xml, pugi::xml_node node, const PlanElement& element,
                  Complex center) {
  const Complex chord = element.end - element.start;
  const double aside = cross(chord, center - element.start) / std::abs(chord);
  // A centre near the chord, as that of a half circle, says nothing.
  const bool clear = std::abs(aside) > 1e-3 / std::abs(element.first_curvature);
  const double expected = element.first_curvature * (std::numbers::pi - std::abs(element.turn()));
  if (!clear || !(aside * expected < 0)) return;
  xml.refuse_at(node, "has rot=" + std::string(*xml.attribute(node, "rot")) +
                          ", but its Center lies on the other side. " + xml.swapped_advice());
}

/// Makes the element an arc. length: as declared.
void set_arc(const LandXml& xml, pugi::xml_node node, const std::optional<double>& length,
             PlanElement& element) {
  const double sense = xml.named(node, "rot", kSenses);
  const auto center = xml.find_place(node, "Center");
  const auto given = xml.length(node, "radius");
  if (!center && (!given || !length)) {
    xml.refuse_at(node, std::string("has neither ") + (given ? "length" : "radius") +
                            " nor Center; expected one of them");
  }
  const double radius = given ? *given : std::abs(element.start - *center);
  if (!(radius > 0)) {
    xml.refuse_at(node, "has the radius " + format_digits(radius, 9) + " m; expected more than 0");
  }
  element.first_curvature = element.last_curvature = sense / radius;
  if (element.start == element.end && !(length && *length < kSameStation)) {
    xml.refuse_at(node,
                  "ends where it starts, but has a length; expected less than a full circle, as "
                  "closed curves are not read");
  }
  if (!length) {
    const double angle =
        sense * std::arg((element.end - *center) * std::conj(element.start - *center));
    element.length = radius * (angle < 0 ? angle + 2 * std::numbers::pi : angle);
  }
  check_turn(xml, node, element);
  if (center && length) check_center(xml, node, element, *center);
}

/// The curvature of an end of a clothoid without its sense; 0 for the radius 0 and INF.
double curvature(const LandXml& xml, pugi::xml_node node, const char* name) {
  const auto text = xml.required(xml.attribute(node, name), node, name, "a radius or INF");
  const auto radius = whole_number_of<double>(without_space_around(text));
  if (!radius || !(*radius >= 0)) {
    xml.refuse_value(node, name, "a radius above 0, or INF");
  }
  const double metres = *radius * xml.metres_per_unit();
  return metres == 0 || std::isinf(metres) ? 0 : 1 / metres;
}

/// Makes the element a clothoid.
void set_clothoid(const LandXml& xml, pugi::xml_node node, const std::optional<double>& length,
                  PlanElement& element) {
  constexpr NamedValue<bool> kRead[] = {{"clothoid", true}};
  xml.named(node, "spiType", kRead, {}, ", as other spirals are not read");
  const double sense = xml.named(node, "rot", kSenses);
  xml.required(length, node, "length", "the length of the spiral");
  element.first_curvature = sense * curvature(xml, node, "radiusStart");
  element.last_curvature = sense * curvature(xml, node, "radiusEnd");
}

/// The part that a node describes; nullopt for a feature and for an element without a length.
std::optional<PlanPart> plan_part(const LandXml& xml, pugi::xml_node node) {
  const std::string_view kind = node.name();
  if (kind == "Feature") return std::nullopt;
  if (kind != "Line" && kind != "Curve" && kind != "Spiral") {
    xml.refuse_at(node,
                  "is no element that is read; expected Line, Curve or Spiral. Export the "
                  "alignment as lines, arcs and clothoids");
  }
  PlanElement element{.start = xml.place(node, "Start"), .end = xml.place(node, "End")};
  const auto length = xml.length(node, "length", 0);
  const double chord = std::abs(element.end - element.start);
  if (!length && chord < kSameStation) return std::nullopt;
  element.length = length.value_or(chord);
  if (kind == "Curve") set_arc(xml, node, length, element);
  if (kind == "Spiral") set_clothoid(xml, node, length, element);
  if (element.length < kSameStation) return std::nullopt;
  check_turn(xml, node, element);
  return PlanPart{node, element, kind == "Curve" && !length};
}

AlignmentPlan plan_of(const std::vector<PlanPart>& parts, double first_station) {
  std::vector<PlanElement> elements;
  for (const PlanPart& part : parts) elements.push_back(part.element);
  return AlignmentPlan(std::move(elements), first_station);
}

/// The changes of direction between the elements of a plan.
Excess kinks_of(const AlignmentPlan& plan) {
  Excess kinks;
  for (std::size_t i = 0; i + 1 < plan.elements().size(); ++i) {
    kinks.add(std::abs(plan.kink_after(i)), kKink, plan.station_of(i + 1));
  }
  return kinks;
}

/// Refuses a plan with kinks that would not be there if all its curves turned the other way, as
/// swapped coordinates have it.
void check_mirrored(const LandXml& xml, const AlignmentPlan& plan, std::vector<PlanPart> parts) {
  const Excess kinks = kinks_of(plan);
  if (kinks.places == 0) return;
  for (PlanPart& part : parts) {
    PlanElement& element = part.element;
    element.first_curvature *= -1;
    element.last_curvature *= -1;
    // From its start to its end in the other sense, an arc takes the rest of its circle.
    if (!part.arc_found) continue;
    element.length = 2 * std::numbers::pi / std::abs(element.first_curvature) - element.length;
  }
  if (kinks_of(plan_of(parts, plan.first_station())).places > 0) return;
  refuse(xml.name(),
         "the direction jumps by up to {} degrees between the elements of the plan, but nowhere if "
         "all curves turned the other way. {}",
         format_brief(kinks.most * 180 / std::numbers::pi), xml.swapped_advice());
}

/// Refuses gaps, and elements whose ends do not fit their length and curvature.
void check_fit(const LandXml& xml, const std::vector<PlanPart>& parts, const AlignmentPlan& plan,
               double max_gap) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto check = [&](double metres, const char* before, const char* behind) {
      if (metres <= max_gap) return;
      // What is missing by more is no matter of rounding.
      constexpr double kMayBeRounding = 0.1;
      const std::string remedy =
          metres <= kMayBeRounding
              ? "; --max-gap " + format_number(std::ceil(metres * 1e4) / 1e4) + " allows it"
              : "";
      xml.refuse_at(parts[i].node, before + metres_text(metres) + behind + "; expected at most " +
                                       metres_text(max_gap) + " m" + remedy);
    };
    check(plan.gap_after(i), "ends ", " m from where the next element starts");
    check(std::abs(plan.misfit_of(i)), "does not fit its ends: by length and radius they are ",
          " m nearer or farther apart");
  }
}

void remark_kinks(const LandXml& xml, const AlignmentPlan& plan, AlignmentFile& out) {
  const Excess kinks = kinks_of(plan);
  if (kinks.places == 0) return;
  const double degrees = kinks.most * 180 / std::numbers::pi;
  const double station = xml.in_units(kinks.station);
  out.warn("alignment-kink", {{"places", kinks.places}, {"degrees", degrees}, {"station", station}},
           "{}: the direction jumps between elements at {}, by up to {} degrees at station {}. "
           "There the vehicle turns on the spot, so check the curves of the file",
           xml.name(), counted(kinks.places, "place"), format_brief(degrees), metres_text(station));
}

/// Warns where lengths and stations that the file declares are not those of its elements.
void remark_declared(const LandXml& xml, pugi::xml_node alignment,
                     const std::vector<PlanPart>& parts, const AlignmentPlan& plan,
                     AlignmentFile& out) {
  const double sum = plan.last_station() - plan.first_station();
  const auto length = xml.length(alignment, "length");
  if (length && !(std::abs(*length - sum) <= kDeclared)) {
    out.warn("alignment-length", {{"declared", *length}, {"elements", sum}},
             "{}: the alignment is declared to be {} m long, but its elements are {} m together, "
             "which counts. Elements may be missing in the file",
             xml.name(), metres_text(*length), metres_text(sum));
  }
  Excess off;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double sound = plan.station_of(i);
    const double declared = xml.length(parts[i].node, "staStart").value_or(sound);
    off.add(std::abs(declared - sound), kDeclared, sound);
  }
  if (off.places == 0) return;
  const double station = xml.in_units(off.station);
  out.warn(
      "alignment-stations", {{"elements", off.places}, {"metres", off.most}, {"station", station}},
      "{}: the declared stations of {} differ from the sum of the lengths before them, by up to {} "
      "m at station {}. The sum counts; heights and cant may then belong to other places",
      xml.name(), counted(off.places, "element"), metres_text(off.most), metres_text(station));
}

/// Refuses a station that is not after the one before it.
void check_ascending(const LandXml& xml, pugi::xml_node node, double station, double before) {
  if (station > before) return;
  xml.refuse_at(node, "stands at station " + xml.unit_text(station) +
                          ", not after the one before it; expected ascending stations");
}

}  // namespace

AlignmentPlan read_plan(const LandXml& xml, pugi::xml_node alignment, double max_gap,
                        AlignmentFile& out) {
  const pugi::xml_node geometry = xml.only_child(alignment, "CoordGeom");
  if (!geometry) xml.refuse_at(alignment, "has no CoordGeom; expected the elements of the plan");
  std::vector<PlanPart> parts;
  for (const pugi::xml_node node : geometry.children()) {
    if (node.type() != pugi::node_element) continue;
    if (const auto part = plan_part(xml, node)) parts.push_back(*part);
  }
  if (parts.empty()) {
    xml.refuse_at(geometry, "has no element with a length; expected Line, Curve or Spiral");
  }
  AlignmentPlan plan = plan_of(parts, xml.required(xml.length(alignment, "staStart"), alignment,
                                                   "staStart", "the station at which it begins"));
  check_mirrored(xml, plan, parts);
  check_fit(xml, parts, plan, max_gap);
  remark_kinks(xml, plan, out);
  remark_declared(xml, alignment, parts, plan, out);
  return plan;
}

pugi::xml_node choose_by_name(const LandXml& xml, const std::vector<pugi::xml_node>& nodes,
                              const std::string& wanted, const std::string& noun,
                              const std::string& option) {
  std::vector<pugi::xml_node> found;
  std::vector<std::string> names;
  for (const pugi::xml_node node : nodes) {
    names.push_back(xml.name_of(node));
    if (wanted.empty() || names.back() == wanted) found.push_back(node);
  }
  if (found.size() == 1) return found[0];
  if (found.empty()) {
    refuse(xml.name(), "has no " + noun + " of the name " + excerpt(wanted) + "; expected one of " +
                           listed(names));
  }
  refuse(xml.name(), "has {}{}", counted(found.size(), noun),
         wanted.empty() ? ": " + listed(names) + "; choose one by its name, with " + option
                        : " of the name " + excerpt(wanted) +
                              "; expected one. Give them different names in the file");
}

namespace {

/// A point of a profile and the node that describes it.
struct ProfilePart {
  pugi::xml_node node;
  VerticalIntersection point;

  bool is_curve() const { return point.curve != VerticalIntersection::Curve::kNone; }
};

ProfilePart profile_part(const LandXml& xml, pugi::xml_node node) {
  const std::string_view kind = node.name();
  const bool even = kind == "ParaCurve", uneven = kind == "UnsymParaCurve";
  const bool circle = kind == "CircCurve";
  if (!even && !uneven && !circle && kind != "PVI") {
    xml.refuse_at(node,
                  "is no element that is read; expected PVI, ParaCurve, UnsymParaCurve or "
                  "CircCurve");
  }
  const auto numbers = xml.numbers(node, 2, 2, "a station and a height");
  VerticalIntersection point{.station = xml.in_metres(numbers[0]),
                             .height = xml.in_metres(numbers[1])};
  const auto length = [&](const char* name) {
    return xml.required(xml.length(node, name, 0), node, name, "a level length of the curve");
  };
  if (even) point.before = point.after = length("length") / 2;
  if (uneven) point.before = length("lengthIn");
  if (uneven) point.after = length("lengthOut");
  if ((point.before == 0) != (point.after == 0)) {
    xml.refuse_at(node,
                  "has a curve on one side of its point only; expected lengthIn and lengthOut "
                  "above 0");
  }
  if (point.before > 0) point.curve = VerticalIntersection::Curve::kParabola;
  if (circle) {
    point.curve = VerticalIntersection::Curve::kCircle;
    point.radius = std::abs(
        xml.required(xml.length(node, "radius"), node, "radius", "the radius of the curve"));
    if (point.radius == 0) xml.refuse_at(node, "has the radius 0; expected another one");
  }
  return {node, point};
}

/// Joins a PVI and the curve at it, which some programs write as two elements, to one point: the
/// curve. Returns false where this point and the one before it are no such pair.
bool join(const LandXml& xml, ProfilePart& before, const ProfilePart& part) {
  const bool is_pvi = std::string_view(part.node.name()) == "PVI";
  const bool was_pvi = std::string_view(before.node.name()) == "PVI";
  if (is_pvi == was_pvi || !(std::abs(part.point.station - before.point.station) <= kSameStation)) {
    return false;
  }
  if (!(std::abs(part.point.height - before.point.height) <= kDeclared)) {
    xml.refuse_at(part.node, "has the height " + xml.unit_text(part.point.height) + ", and " +
                                 excerpt(before.node.name()) + " at the same station " +
                                 xml.unit_text(part.point.station) + " has " +
                                 xml.unit_text(before.point.height) +
                                 "; expected one height at a station");
  }
  if (was_pvi) before = part;
  return true;
}

}  // namespace

std::optional<AlignmentProfile> read_profile(const LandXml& xml, pugi::xml_node alignment,
                                             const AlignmentOptions& options, AlignmentFile& out) {
  std::vector<pugi::xml_node> profiles;
  for (const pugi::xml_node profile : alignment.children("Profile")) {
    for (const pugi::xml_node node : profile.children("ProfAlign")) profiles.push_back(node);
  }
  if (profiles.empty()) {
    if (!options.profile.empty()) {
      refuse(xml.name(), "has no profile of the name " + excerpt(options.profile) +
                             ", as its alignment has none");
    }
    return std::nullopt;
  }
  const pugi::xml_node chosen =
      choose_by_name(xml, profiles, options.profile, "profile", "--profile");
  out.profile = xml.name_of(chosen);
  std::vector<ProfilePart> parts;
  for (const pugi::xml_node node : chosen.children()) {
    if (node.type() != pugi::node_element || std::string_view(node.name()) == "Feature") continue;
    const ProfilePart part = profile_part(xml, node);
    if (!parts.empty() && join(xml, parts.back(), part)) continue;
    if (!parts.empty()) {
      check_ascending(xml, node, part.point.station, parts.back().point.station);
    }
    parts.push_back(part);
  }
  if (parts.size() < 2) {
    xml.refuse_at(chosen, "has " + counted(parts.size(), "point") + "; expected at least two");
  }
  std::vector<VerticalIntersection> points;
  for (const ProfilePart& part : parts) points.push_back(part.point);
  for (const ProfilePart* const end : {&parts.front(), &parts.back()}) {
    if (!end->is_curve()) continue;
    xml.refuse_at(end->node,
                  "is a curve at an end of the profile, where no slope lies beyond it; expected a "
                  "PVI");
  }
  AlignmentProfile profile(std::move(points));
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const double overlap = profile.overlap_before(i);
    if (overlap <= options.max_gap) continue;
    const std::string by = metres_text(overlap);
    xml.refuse_at(parts[i].node, "{}; expected curves that do not overlap",
                  parts[i].is_curve() ? "its curve begins " + by +
                                            " m before the previous point or the end of its curve"
                                      : "the curve before it ends " + by + " m beyond it");
  }
  return profile;
}

namespace {

/// The values of rotationPoint.
constexpr NamedValue<CantLine> kLines[] = {{"center", CantLine::kCenter},
                                           {"insideRail", CantLine::kInsideRail},
                                           {"outsideRail", CantLine::kOutsideRail},
                                           {"leftRail", CantLine::kLeftRail},
                                           {"rightRail", CantLine::kRightRail}};

/// The values of transitionType that are read. A clothoid's cant changes as its curvature does.
constexpr NamedValue<CantRamp> kRamps[] = {
    {"linear", CantRamp::kLinear}, {"clothoid", CantRamp::kLinear},
    {"bloss", CantRamp::kBloss},   {"sinusoid", CantRamp::kSinusoid},
    {"cosine", CantRamp::kCosine}, {"sineHalfWave", CantRamp::kCosine}};

constexpr NamedValue<bool> kFlags[] = {{"true", true}, {"1", true}, {"false", false}, {"0", false}};

/// Warns where a station names a ramp that begins nowhere, while the ramp that ends there is of
/// another kind, because the file may mean that one.
void remark_ramps(const LandXml& xml, const std::vector<CantPoint>& points,
                  const std::vector<bool>& named, AlignmentFile& out) {
  constexpr int kSteps = 100;
  Excess apart;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double change = points[i].cant - points[i - 1].cant;
    const bool begins_none = i + 1 == points.size() || points[i + 1].cant == points[i].cant;
    if (!named[i] || !begins_none || change == 0 || points[i].ramp == points[i - 1].ramp) continue;
    double most = 0;
    for (int step = 1; step < kSteps; ++step) {
      const double share = static_cast<double>(step) / kSteps;
      most = std::max(most, std::abs(change * (along_ramp(points[i].ramp, share).value -
                                               along_ramp(points[i - 1].ramp, share).value)));
    }
    apart.add(most, 0, xml.in_units(points[i].station));
  }
  if (apart.places == 0) return;
  out.warn("cant-transition",
           xml.name() + ": " + counted(apart.places, "station") +
               " of cant names a transitionType where no ramp begins, and the ramp that ends there "
               "has another one. A type was taken for the ramp that begins at its station; "
               "otherwise the cant would differ by up to " +
               metres_text(apart.most) + " m before station " + metres_text(apart.station),
           {{"stations", apart.places}, {"metres", apart.most}, {"station", apart.station}});
}

/// The cant of a station, positive with the left rail high.
CantPoint cant_point(const LandXml& xml, pugi::xml_node node) {
  const double station =
      xml.required(xml.length(node, "station"), node, "station", "the internal station");
  const double applied =
      xml.required(xml.number(node, "appliedCant"), node, "appliedCant", "the cant");
  const double metres = applied * (xml.is_imperial() ? kMetresPerInch : kMetresPerMillimetre);
  const CantRamp ramp = xml.named(node, "transitionType", kRamps, std::optional(CantRamp::kLinear),
                                  ", as other ramps of cant are not read, or --cant none");
  if (metres == 0) return {station, 0, ramp};
  const double sense = xml.named(node, "curvature", kSenses, {}, ", which says which rail is high");
  const bool turned = xml.named(node, "adverse", kFlags, std::optional(false));
  return {station, metres * (turned ? sense : -sense), ramp};
}

std::vector<CantPoint> cant_points(const LandXml& xml, pugi::xml_node cant, AlignmentFile& out) {
  std::vector<CantPoint> points;
  std::vector<bool> named;  // whether the station of each point names its ramp
  for (const pugi::xml_node node : cant.children("CantStation")) {
    const CantPoint point = cant_point(xml, node);
    named.push_back(xml.attribute(node, "transitionType").has_value());
    if (!points.empty()) check_ascending(xml, node, point.station, points.back().station);
    points.push_back(point);
  }
  if (points.empty()) {
    xml.refuse_at(cant, "has no CantStation; expected at least one, or --cant none");
  }
  remark_ramps(xml, points, named, out);
  return points;
}

CantLine line_of(const LandXml& xml, pugi::xml_node cant, const AlignmentOptions& options,
                 AlignmentFile& out) {
  if (options.cant != CantLine::kFile) return options.cant;
  const CantLine line = xml.named(cant, "rotationPoint", kLines, std::optional(CantLine::kFile),
                                  "; --cant names it instead");
  if (line != CantLine::kFile) return line;
  out.warn("cant-rotation",
           xml.name() +
               ": the cant does not say about which rail it turns the track, so the inner rail was "
               "taken. If another rail keeps the height of the profile, name it with --cant");
  return CantLine::kInsideRail;
}

/// The gauge in metres; nullopt where the file has none.
std::optional<double> gauge_of(const LandXml& xml, pugi::xml_node cant) {
  constexpr double kMostGauge = 10;
  const auto number = xml.number(cant, "gauge");
  if (number && !(*number > 0 && *number <= kMostGauge)) {
    xml.refuse_value(cant, "gauge",
                     fmt::format("a number above 0 and up to {} in the file's unit, the {}, for "
                                 "example 1.435 in metres",
                                 format_number(kMostGauge), xml.unit_name()));
  }
  return xml.length(cant, "gauge");
}

/// The distance of the rails in metres.
double rail_distance_of(const LandXml& xml, pugi::xml_node cant, std::optional<double> gauge,
                        const AlignmentOptions& options) {
  constexpr double kNormal = 1.435, kNormalMiddles = 1.5, kSameGauge = 0.0005;
  if (options.rail_distance) return *options.rail_distance;
  for (const double known : {kNormal, kNormalMiddles}) {
    if (gauge && std::abs(*gauge - known) <= kSameGauge) return kNormalMiddles;
  }
  xml.refuse_at(cant, (gauge ? "has a gauge of " + metres_text(*gauge) + " m"
                             : std::string("has no attribute gauge")) +
                          ", so the distance of the rails' middles is not known; --rail-distance "
                          "gives it in metres");
}

}  // namespace

void read_cant(const LandXml& xml, pugi::xml_node alignment, const AlignmentOptions& options,
               Alignment& track, AlignmentFile& out) {
  if (options.cant == CantLine::kNone && alignment.child("Cant")) return;
  const pugi::xml_node cant = xml.only_child(alignment, "Cant", ", or --cant none");
  if (!cant) {
    if (options.cant == CantLine::kFile && !options.rail_distance) return;
    out.note("no-cant",
             xml.name() + ": the alignment has no cant, so options of cant change nothing");
    return;
  }
  std::vector<CantPoint> points = cant_points(xml, cant, out);
  double most = 0;
  for (const CantPoint& point : points) most = std::max(most, std::abs(point.cant));
  const auto gauge = gauge_of(xml, cant);
  if (most == 0) return;
  const double distance = rail_distance_of(xml, cant, gauge, options);
  if (!(most < distance)) {
    xml.refuse_at(cant, "raises a rail by up to " + format_digits(most, 9) + " m, with rails " +
                            format_digits(distance, 9) + " m apart; expected a cant in " +
                            (xml.is_imperial() ? "inches" : "millimetres"));
  }
  track.cant_line = line_of(xml, cant, options, out);
  track.rail_distance = distance;
  track.cant.emplace(std::move(points));
}

void remark_left_out(const LandXml& xml, pugi::xml_node alignment, AlignmentFile& out) {
  if (alignment.child("Superelevation")) {
    out.warn("superelevation", fmt::format("{}: the superelevation of the road is not read, so the "
                                           "poses are level across where the road leans",
                                           xml.name()));
  }
  std::size_t count = 0;
  std::string first;
  for (const pugi::xml_node node : alignment.children("StaEquation")) {
    const auto ahead = xml.number(node, "staAhead"), internal = xml.number(node, "staInternal");
    if (count++ == 0 && ahead && internal) {
      first = "; the first calls the internal station " + format_digits(*internal, 9) + " " +
              format_digits(*ahead, 9);
    }
  }
  if (count == 0) return;
  out.warn("station-equations",
           xml.name() + ": " + counted(count, "equation") + " of stations" + first +
               ". All stations that are given and written are internal ones, which run on evenly",
           {{"equations", count}});
}

}  // namespace clearway
