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
#include "io/files/input_error.hpp"

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

/// What to do where the coordinates seem to be swapped. order: the one in which they were read.
std::string swapped_advice(AxisOrder order) {
  return std::string("The coordinates were read as ") +
         (order == AxisOrder::kNorthingEasting
              ? "northing, easting; if the file has easting first, give --order en"
              : "easting, northing; if the file has northing first, give --order ne");
}

/// Reads the elements of a plan.
class PlanReader {
 public:
  PlanReader(const LandXml& xml, const AlignmentOptions& options) : xml_(xml), options_(options) {}

  /// Adds the element of a node, unless it has no length.
  void add(pugi::xml_node node) {
    const std::string_view kind = kind_of(node);
    const bool is_read = kind == "Line" || kind == "Curve" || kind == "Spiral";
    if (is_read && is_empty(node)) return;
    PlanElement element;
    if (kind == "Line") {
      element = line(node);
    } else if (kind == "Curve") {
      element = curve(node);
    } else if (kind == "Spiral") {
      element = spiral(node);
    } else if (kind == "Feature") {
      return;
    } else {
      xml_.refuse_at(node,
                     "is no element that is read; expected Line, Curve or Spiral. Export the "
                     "alignment as lines, arcs and clothoids");
    }
    if (!(element.length >= 0)) {
      xml_.refuse_at(
          node, "has the length " + format_digits(element.length, 9) + " m; expected 0 or more");
    }
    if (element.length < kSameStation) return;
    check_turn(node, element);
    elements.push_back(element);
    nodes.push_back(node);
    arc_found.push_back(kind == "Curve" && !xml_.attribute(node, "length"));
  }

  std::vector<PlanElement> elements;
  std::vector<pugi::xml_node> nodes;
  /// Whether each element is an arc whose length follows from its centre and its sense
  std::vector<bool> arc_found;

 private:
  /// The place of a point: x is easting.
  Complex place(Complex file) const {
    return options_.order == AxisOrder::kNorthingEasting ? Complex(file.imag(), file.real()) : file;
  }
  Complex place(pugi::xml_node node, const char* name) const {
    return place(xml_.point(node, name));
  }

  PlanElement between_ends(pugi::xml_node node) const {
    return {.start = place(node, "Start"), .end = place(node, "End")};
  }

  /// Whether an element that declares no length ends where it starts.
  bool is_empty(pugi::xml_node node) const {
    if (xml_.attribute(node, "length")) return false;
    const PlanElement element = between_ends(node);
    return std::abs(element.end - element.start) < kSameStation;
  }

  PlanElement line(pugi::xml_node node) const {
    PlanElement element = between_ends(node);
    element.length = xml_.length(node, "length").value_or(std::abs(element.end - element.start));
    return element;
  }

  /// 1 for a turn to the left, -1 to the right.
  double sense_of(pugi::xml_node node) const {
    const auto rot = xml_.attribute(node, "rot");
    if (rot == "ccw") return 1;
    if (rot == "cw") return -1;
    xml_.refuse_at(node, rot ? "has rot=" + excerpt(*rot) + "; expected cw or ccw"
                             : "has no attribute rot; expected cw or ccw");
  }

  PlanElement curve(pugi::xml_node node) const {
    PlanElement element = between_ends(node);
    const double sense = sense_of(node);
    const auto found = xml_.find_point(node, "Center");
    const auto given = xml_.length(node, "radius"), length = xml_.length(node, "length");
    if (!found && !given)
      xml_.refuse_at(node, "has neither radius nor Center; expected one of them");
    if (!found && !length)
      xml_.refuse_at(node, "has neither length nor Center; expected one of them");
    const Complex center = found ? place(*found) : Complex();
    const double radius = given ? *given : std::abs(element.start - center);
    if (!(radius > 0)) {
      xml_.refuse_at(node,
                     "has the radius " + format_digits(radius, 9) + " m; expected more than 0");
    }
    element.first_curvature = element.last_curvature = sense / radius;
    if (element.start == element.end && !(length && *length < kSameStation)) {
      xml_.refuse_at(node,
                     "ends where it starts, but has a length; expected less than a full circle, as "
                     "closed curves are not read");
    }
    element.length = length ? *length : radius * angle_about(center, element, sense);
    check_turn(node, element);
    if (found && length) check_center(node, element, center);
    return element;
  }

  void check_turn(pugi::xml_node node, const PlanElement& element) const {
    if (!(std::abs(element.turn()) < 2 * std::numbers::pi)) {
      xml_.refuse_at(node, "turns by " +
                               format_digits(std::abs(element.turn()) * 180 / std::numbers::pi, 9) +
                               " degrees; expected less than a full circle, as closed curves are "
                               "not read");
    }
  }

  /// Angle from start to end about the centre in the sense of the curve, from 0 to 2 pi.
  static double angle_about(Complex center, const PlanElement& element, double sense) {
    const double angle =
        sense * std::arg((element.end - center) * std::conj(element.start - center));
    return angle < 0 ? angle + 2 * std::numbers::pi : angle;
  }

  /// Refuses a centre that lies on the other side of the chord than the curve's sense and length
  /// say, as with swapped coordinates.
  void check_center(pugi::xml_node node, const PlanElement& element, Complex center) const {
    const Complex chord = element.end - element.start;
    const double aside = cross(chord, center - element.start) / std::abs(chord);
    const double turn = std::abs(element.turn());
    // A centre near the chord, as that of a half circle, says nothing.
    const bool clear = std::abs(aside) > 1e-3 / std::abs(element.first_curvature);
    const double expected = element.first_curvature * (std::numbers::pi - turn);
    if (!clear || !(aside * expected < 0)) return;
    xml_.refuse_at(node, "has rot=" + std::string(*xml_.attribute(node, "rot")) +
                             ", but its Center lies on the other side. " +
                             swapped_advice(options_.order));
  }

  double curvature(pugi::xml_node node, const char* name) const {
    const auto text = xml_.attribute(node, name);
    if (!text)
      xml_.refuse_at(node, "has no attribute " + std::string(name) + "; expected a radius or INF");
    const auto radius = whole_number_of<double>(without_space_around(*text));
    if (!radius || !(*radius >= 0)) {
      xml_.refuse_at(node, "has " + std::string(name) + "=" + excerpt(*text) +
                               "; expected a radius above 0, or INF");
    }
    const double metres = *radius * xml_.metres_per_unit();
    return metres == 0 || std::isinf(metres) ? 0 : 1 / metres;
  }

  PlanElement spiral(pugi::xml_node node) const {
    const auto type = xml_.attribute(node, "spiType");
    if (!type) xml_.refuse_at(node, "has no attribute spiType; expected clothoid");
    if (*type != "clothoid") {
      xml_.refuse_at(
          node, "is a spiral of type " + excerpt(*type) + ", which is not read; expected clothoid");
    }
    PlanElement element = between_ends(node);
    const double sense = sense_of(node);
    element.length = xml_.required_length(node, "length", "the length of the spiral");
    element.first_curvature = sense * curvature(node, "radiusStart");
    element.last_curvature = sense * curvature(node, "radiusEnd");
    return element;
  }

  const LandXml& xml_;
  const AlignmentOptions& options_;
};

double greatest_kink(const AlignmentPlan& plan, std::size_t* where = nullptr) {
  double most = 0;
  for (std::size_t i = 0; i + 1 < plan.elements().size(); ++i) {
    const double kink = std::abs(plan.kink_after(i));
    if (!(kink > most)) continue;
    most = kink;
    if (where != nullptr) *where = i;
  }
  return most;
}

/// Whether the plan has kinks that would not be there if all its curves turned the other way, as
/// swapped coordinates have it.
bool is_mirrored(const AlignmentPlan& plan, const PlanReader& read) {
  if (!(greatest_kink(plan) > kKink)) return false;
  std::vector<PlanElement> turned = plan.elements();
  for (std::size_t i = 0; i < turned.size(); ++i) {
    PlanElement& element = turned[i];
    element.first_curvature *= -1;
    element.last_curvature *= -1;
    // From its start to its end in the other sense, an arc takes the rest of its circle.
    if (!read.arc_found[i]) continue;
    element.length = 2 * std::numbers::pi / std::abs(element.first_curvature) - element.length;
  }
  return greatest_kink(AlignmentPlan(std::move(turned), plan.first_station())) <= kKink;
}

/// Refuses gaps, and elements whose ends do not fit their length and curvature.
void check_fit(const LandXml& xml, const PlanReader& read, const AlignmentPlan& plan,
               double max_gap) {
  for (std::size_t i = 0; i < read.nodes.size(); ++i) {
    const double gap = plan.gap_after(i), misfit = std::abs(plan.misfit_of(i));
    // What is missing by more is no matter of rounding.
    constexpr double kMayBeRounding = 0.1;
    const auto allowed = [](double metres) {
      if (!(metres <= kMayBeRounding)) return std::string();
      return "; --max-gap " + format_number(std::ceil(metres * 1e4) / 1e4) + " allows it";
    };
    if (!(gap <= max_gap)) {
      xml.refuse_at(read.nodes[i], "ends " + metres_text(gap) +
                                       " m from where the next element starts; expected at most " +
                                       metres_text(max_gap) + " m" + allowed(gap));
    }
    if (!(misfit <= max_gap)) {
      xml.refuse_at(read.nodes[i], "does not fit its ends: by length and radius they are " +
                                       metres_text(misfit) +
                                       " m nearer or farther apart; expected at most " +
                                       metres_text(max_gap) + " m" + allowed(misfit));
    }
  }
}

void remark_kinks(const LandXml& xml, const AlignmentPlan& plan, AlignmentFile& out,
                  const std::string& name) {
  std::size_t where = 0, count = 0;
  const double most = greatest_kink(plan, &where);
  if (!(most > kKink)) return;
  for (std::size_t i = 0; i + 1 < plan.elements().size(); ++i) {
    count += std::abs(plan.kink_after(i)) > kKink ? 1 : 0;
  }
  const double degrees = most * 180 / std::numbers::pi;
  const double station = plan.station_of(where + 1) / xml.metres_per_unit();
  out.warn("alignment-kink",
           name + ": the direction jumps between elements at " + counted(count, "place") +
               ", by up to " + format_brief(degrees) + " degrees at station " +
               metres_text(station) +
               ". There the vehicle turns on the spot, so check the curves of the file",
           {{"places", static_cast<double>(count)}, {"degrees", degrees}, {"station", station}});
}

/// Warns where lengths and stations that the file declares are not those of its elements.
void remark_declared(const LandXml& xml, pugi::xml_node alignment, const PlanReader& read,
                     const AlignmentPlan& plan, AlignmentFile& out, const std::string& name) {
  const double sum = plan.last_station() - plan.first_station();
  const auto length = xml.length(alignment, "length");
  if (length && !(std::abs(*length - sum) <= kDeclared)) {
    out.warn("alignment-length",
             name + ": the alignment is declared to be " + metres_text(*length) +
                 " m long, but its elements are " + metres_text(sum) +
                 " m together, which counts. Elements may be missing in the file",
             {{"declared", *length}, {"elements", sum}});
  }
  std::size_t count = 0;
  double most = 0, at = 0;
  for (std::size_t i = 0; i < read.nodes.size(); ++i) {
    const auto declared = xml.length(read.nodes[i], "staStart");
    if (!declared) continue;
    const double off = std::abs(*declared - plan.station_of(i));
    if (off <= kDeclared) continue;
    ++count;
    if (off > most) {
      most = off;
      at = plan.station_of(i) / xml.metres_per_unit();
    }
  }
  if (count == 0) return;
  out.warn("alignment-stations",
           name + ": the declared stations of " + counted(count, "element") +
               " differ from the sum of the lengths before them, by up to " + metres_text(most) +
               " m at station " + metres_text(at) +
               ". The sum counts; heights and cant may then belong to other places",
           {{"elements", static_cast<double>(count)}, {"metres", most}, {"station", at}});
}

}  // namespace

AlignmentPlan read_plan(const LandXml& xml, pugi::xml_node alignment,
                        const AlignmentOptions& options, AlignmentFile& out) {
  const pugi::xml_node geometry = xml.only_child(alignment, "CoordGeom");
  if (!geometry) xml.refuse_at(alignment, "has no CoordGeom; expected the elements of the plan");
  PlanReader read(xml, options);
  for (const pugi::xml_node node : geometry.children()) {
    if (node.type() == pugi::node_element) read.add(node);
  }
  if (read.elements.empty()) {
    xml.refuse_at(geometry, "has no element with a length; expected Line, Curve or Spiral");
  }
  AlignmentPlan plan(read.elements,
                     xml.required_length(alignment, "staStart", "the station at which it begins"));
  const std::string name = xml.name();
  if (is_mirrored(plan, read)) {
    refuse(name, "the direction jumps by up to " +
                     format_brief(greatest_kink(plan) * 180 / std::numbers::pi) +
                     " degrees between the elements of the plan, but nowhere if all curves turned "
                     "the other way. " +
                     swapped_advice(options.order));
  }
  check_fit(xml, read, plan, options.max_gap);
  remark_kinks(xml, plan, out, name);
  remark_declared(xml, alignment, read, plan, out, name);
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
  refuse(xml.name(),
         "has " + counted(found.size(), noun) +
             (wanted.empty() ? ": " + listed(names) + "; choose one by its name, with " + option
                             : " of the name " + excerpt(wanted) +
                                   "; expected one. Give them different names in the file"));
}

namespace {

class ProfileReader {
 public:
  explicit ProfileReader(const LandXml& xml) : xml_(xml) {}

  void add(pugi::xml_node node) {
    const std::string_view kind = kind_of(node);
    if (kind == "Feature") return;
    if (kind != "PVI" && kind != "ParaCurve" && kind != "UnsymParaCurve" && kind != "CircCurve") {
      xml_.refuse_at(node,
                     "is no element that is read; expected PVI, ParaCurve, UnsymParaCurve or "
                     "CircCurve");
    }
    const auto numbers = xml_.numbers(node, 2, 2, "a station and a height");
    const UnitFactor metres(xml_.metres_per_unit());
    VerticalIntersection point{.station = metres(numbers[0]), .height = metres(numbers[1])};
    if (kind == "ParaCurve") {
      const double length = positive(node, "length", "the level length of the curve");
      set_parabola(point, length / 2, length / 2);
    } else if (kind == "UnsymParaCurve") {
      const double in = positive(node, "lengthIn", "the level length before the point");
      const double out = positive(node, "lengthOut", "the level length after the point");
      if ((in == 0) != (out == 0)) {
        xml_.refuse_at(node,
                       "has a curve on one side of its point only; expected lengthIn and "
                       "lengthOut above 0");
      }
      set_parabola(point, in, out);
    } else if (kind == "CircCurve") {
      const double radius =
          std::abs(xml_.required_length(node, "radius", "the radius of the curve"));
      if (!(radius > 0)) xml_.refuse_at(node, "has the radius 0; expected another one");
      point.curve = VerticalIntersection::Curve::kCircle;
      point.radius = radius;
    }
    if (!points.empty() && joins_last(node, point)) return;
    if (!points.empty() && !(point.station > points.back().station)) {
      xml_.refuse_at(node, "stands at station " + format_digits(numbers[0], 9) +
                               ", not after the point before it; expected ascending stations");
    }
    points.push_back(point);
    nodes.push_back(node);
  }

  std::vector<VerticalIntersection> points;
  std::vector<pugi::xml_node> nodes;

 private:
  /// Joins a PVI and the curve at it, which some programs write as two elements, to one point: the
  /// curve. Returns false where this point and the one before it are no such pair.
  bool joins_last(pugi::xml_node node, const VerticalIntersection& point) {
    VerticalIntersection& before = points.back();
    const bool is_pvi = kind_of(node) == "PVI", was_pvi = kind_of(nodes.back()) == "PVI";
    if (is_pvi == was_pvi || !(std::abs(point.station - before.station) <= kSameStation)) {
      return false;
    }
    if (!(std::abs(point.height - before.height) <= kDeclared)) {
      const double unit = xml_.metres_per_unit();
      xml_.refuse_at(node, "has the height " + format_digits(point.height / unit, 9) + ", and " +
                               excerpt(nodes.back().name()) + " at the same station " +
                               format_digits(point.station / unit, 9) + " has " +
                               format_digits(before.height / unit, 9) +
                               "; expected one height at a station");
    }
    if (was_pvi) {
      before = point;
      nodes.back() = node;
    }
    return true;
  }

  double positive(pugi::xml_node node, const char* name, const char* what) const {
    const double length = xml_.required_length(node, name, what);
    if (!(length >= 0)) {
      xml_.refuse_at(node, "has " + std::string(name) + "=" + excerpt(*xml_.attribute(node, name)) +
                               "; expected 0 or more");
    }
    return length;
  }

  static void set_parabola(VerticalIntersection& point, double before, double after) {
    if (before == 0) return;
    point.curve = VerticalIntersection::Curve::kParabola;
    point.before = before;
    point.after = after;
  }

  const LandXml& xml_;
};

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
  ProfileReader read(xml);
  for (const pugi::xml_node node : chosen.children()) {
    if (node.type() == pugi::node_element) read.add(node);
  }
  if (read.points.size() < 2) {
    xml.refuse_at(chosen,
                  "has " + counted(read.points.size(), "point") + "; expected at least two");
  }
  for (const std::size_t end : {std::size_t{0}, read.points.size() - 1}) {
    if (read.points[end].curve == VerticalIntersection::Curve::kNone) continue;
    xml.refuse_at(read.nodes[end],
                  "is a curve at an end of the profile, where no slope lies beyond "
                  "it; expected a PVI");
  }
  AlignmentProfile profile(read.points);
  for (std::size_t i = 1; i < read.points.size(); ++i) {
    const double overlap = profile.overlap_before(i);
    if (overlap <= options.max_gap) continue;
    const std::string by = metres_text(overlap);
    const bool is_curve = read.points[i].curve != VerticalIntersection::Curve::kNone;
    xml.refuse_at(read.nodes[i],
                  (is_curve ? "its curve begins " + by +
                                  " m before the previous point or the end of its curve"
                            : "the curve before it ends " + by + " m beyond it") +
                      "; expected curves that do not overlap");
  }
  return profile;
}

namespace {

struct NamedLine {
  std::string_view name;
  CantLine line;
};

/// The values of rotationPoint.
constexpr NamedLine kLines[] = {{"center", CantLine::kCenter},
                                {"insideRail", CantLine::kInsideRail},
                                {"outsideRail", CantLine::kOutsideRail},
                                {"leftRail", CantLine::kLeftRail},
                                {"rightRail", CantLine::kRightRail}};

struct NamedRamp {
  std::string_view name;
  CantRamp ramp;
};

/// The values of transitionType that are read. A clothoid's cant changes as its curvature does.
constexpr NamedRamp kRamps[] = {{"linear", CantRamp::kLinear}, {"clothoid", CantRamp::kLinear},
                                {"bloss", CantRamp::kBloss},   {"sinusoid", CantRamp::kSinusoid},
                                {"cosine", CantRamp::kCosine}, {"sineHalfWave", CantRamp::kCosine}};

/// How the cant changes from a station to the next one; nullopt where the file does not say.
std::optional<CantRamp> ramp_of(const LandXml& xml, pugi::xml_node node) {
  const auto type = xml.attribute(node, "transitionType");
  if (!type) return std::nullopt;
  const auto* const found =
      std::ranges::find(kRamps, without_space_around(*type), &NamedRamp::name);
  if (found != std::end(kRamps)) return found->ramp;
  std::string known;
  for (const NamedRamp& ramp : kRamps) {
    known += (known.empty() ? "" : ", ") + std::string(ramp.name);
  }
  xml.refuse_at(node, "has transitionType=" + excerpt(*type) +
                          ", a ramp of cant that is not read; expected " + known +
                          ", or --cant none");
}

/// Warns where a station names a ramp that begins nowhere, while the ramp that ends there is of
/// another kind, because the file may mean that one.
void remark_ramps(const LandXml& xml, const std::vector<CantPoint>& points,
                  const std::vector<bool>& named, AlignmentFile& out) {
  constexpr int kSteps = 100;
  std::size_t count = 0;
  double most = 0, at = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double change = points[i].cant - points[i - 1].cant;
    const bool begins_none = i + 1 == points.size() || points[i + 1].cant == points[i].cant;
    if (!named[i] || !begins_none || change == 0 || points[i].ramp == points[i - 1].ramp) continue;
    ++count;
    for (int step = 1; step < kSteps; ++step) {
      const double share = static_cast<double>(step) / kSteps;
      const double apart = std::abs(change * (along_ramp(points[i].ramp, share).value -
                                              along_ramp(points[i - 1].ramp, share).value));
      if (apart > most) at = points[i].station / xml.metres_per_unit();
      most = std::max(most, apart);
    }
  }
  if (count == 0) return;
  out.warn("cant-transition",
           xml.name() + ": " + counted(count, "station") +
               " of cant names a transitionType where no ramp begins, and the ramp that ends there "
               "has another one. A type was taken for the ramp that begins at its station; "
               "otherwise the cant would differ by up to " +
               metres_text(most) + " m before station " + metres_text(at),
           {{"stations", static_cast<double>(count)}, {"metres", most}, {"station", at}});
}

/// The cant of a station, positive with the left rail high.
CantPoint cant_point(const LandXml& xml, pugi::xml_node node) {
  const double station = xml.required_length(node, "station", "the internal station");
  const auto applied = xml.number(node, "appliedCant");
  if (!applied) xml.refuse_at(node, "has no attribute appliedCant; expected the cant");
  const double metres = *applied * (xml.is_imperial() ? kMetresPerInch : kMetresPerMillimetre);
  if (metres == 0) return {station, 0};
  const auto curvature = xml.attribute(node, "curvature");
  if (curvature != "cw" && curvature != "ccw") {
    xml.refuse_at(node, (curvature ? "has curvature=" + excerpt(*curvature)
                                   : std::string("has no attribute curvature")) +
                            "; expected cw or ccw, which says which rail is high");
  }
  const auto adverse = xml.attribute(node, "adverse").value_or("false");
  const bool turned = adverse == "true" || adverse == "1";
  if (!turned && adverse != "false" && adverse != "0") {
    xml.refuse_at(node, "has adverse=" + excerpt(adverse) + "; expected true or false");
  }
  return {station, metres * ((curvature == "cw") == turned ? -1 : 1)};
}

std::vector<CantPoint> cant_points(const LandXml& xml, pugi::xml_node cant, AlignmentFile& out) {
  std::vector<CantPoint> points;
  std::vector<bool> named;  // whether the station of each point names its ramp
  for (const pugi::xml_node node : cant.children("CantStation")) {
    CantPoint point = cant_point(xml, node);
    const auto ramp = ramp_of(xml, node);
    point.ramp = ramp.value_or(CantRamp::kLinear);
    named.push_back(ramp.has_value());
    if (!points.empty() && !(point.station > points.back().station)) {
      xml.refuse_at(node, "stands at station " +
                              format_digits(point.station / xml.metres_per_unit(), 9) +
                              ", not after the one before it; expected ascending stations");
    }
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
  const auto name = xml.attribute(cant, "rotationPoint");
  if (!name) {
    out.warn("cant-rotation",
             xml.name() +
                 ": the cant does not say about which rail it turns the track, so the inner "
                 "rail was taken. If another rail keeps the height of the profile, name it "
                 "with --cant");
    return CantLine::kInsideRail;
  }
  for (const NamedLine& known : kLines) {
    if (known.name == *name) return known.line;
  }
  xml.refuse_at(cant, "has rotationPoint=" + excerpt(*name) +
                          "; expected center, insideRail, outsideRail, leftRail or rightRail; "
                          "--cant names it instead");
}

/// The gauge in metres; nullopt where the file has none.
std::optional<double> gauge_of(const LandXml& xml, pugi::xml_node cant) {
  constexpr double kMostGauge = 10;
  const auto number = xml.number(cant, "gauge");
  if (number && !(*number > 0 && *number <= kMostGauge)) {
    xml.refuse_at(cant, "has gauge=" + excerpt(*xml.attribute(cant, "gauge")) +
                            "; expected a number above 0 and up to " + format_number(kMostGauge) +
                            " in the file's unit, the " + xml.unit_name() +
                            ", for example 1.435 in metres");
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
    out.warn("superelevation",
             xml.name() +
                 ": the superelevation of the road is not read, so the poses are level "
                 "across where the road leans");
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
           {{"equations", static_cast<double>(count)}});
}

}  // namespace clearway
