#pragma once

#include <cstdint>
#include <optional>
#include <type_traits>
#include <vector>

#include "clearway/query.hpp"

namespace clearway {

/// A parameter of a query, with all texts and names for the places that list parameters: the
/// command line, campaigns, results and their comparison, journals, pages and Python. Value: bool,
/// double (a length in metres unless `unit` says otherwise), one that need not be given, a count,
/// or a list.
template <typename Value>
struct QueryField {
  Value QueryParameters::*member;
  const char* name;    ///< name in results, JSON, campaigns and Python
  const char* topic;   ///< name in messages, as in "the radius"
  const char* option;  ///< option of `clearway run`
  const char* help;    ///< help text of that option
  const char* doc;     ///< documentation of the property in Python
  /// The first version of results in which every result has it; 0: only results in which it is not
  /// the default have it.
  std::uint32_t since = 0;
  /// What a number counts.
  enum class Unit { kMetres, kRadians, kNone } unit = Unit::kMetres;

  const Value& of(const QueryParameters& query) const { return query.*member; }
  /// Whether every question has to give it, which has no default.
  bool is_required() const {
    if constexpr (std::is_same_v<Value, double>) {
      return member == &QueryParameters::radius;
    } else {
      return false;
    }
  }
  bool is_default(const QueryParameters& query) const { return of(query) == of(QueryParameters{}); }
  /// Whether only a query with an error budget may change it from its default.
  bool belongs_to_budget() const {
    if constexpr (std::is_same_v<Value, double>) {
      return member == &QueryParameters::sigmas || member == &QueryParameters::gap;
    } else {
      return false;
    }
  }
  /// Whether it says how sure the answer has to be, by an error budget or by seen space.
  bool is_of_certainty() const {
    if constexpr (std::is_same_v<Value, std::optional<double>> ||
                  std::is_same_v<Value, std::uint32_t>) {
      return true;
    } else if constexpr (std::is_same_v<Value, double>) {
      return belongs_to_budget() || member == &QueryParameters::seen_cube;
    } else if constexpr (std::is_same_v<Value, bool>) {
      return member == &QueryParameters::seen;
    } else {
      return false;
    }
  }
  /// Whether lists of a query's parameters name it: those of the first releases always, and later
  /// ones where they are not the default.
  bool is_told(const QueryParameters& query) const {
    if constexpr (std::is_same_v<Value, double>) {
      // With a budget, the answer depends on these also where they are the default.
      if (belongs_to_budget()) return query.has_budget();
    }
    return since > 0 || !is_default(query);
  }
};

/// Calls visit(field) for each parameter that is one value, in the order in which results keep
/// them.
template <typename Visit>
void for_each_value_field(Visit visit) {
  using Q = QueryParameters;
  visit(QueryField<double>{
      &Q::radius, "radius", "radius", "--radius",
      "Search radius in metres, for example 0.1, or with a unit, for example 10cm",
      "A point strictly closer to the model than this collides; metres, above 0.", 2});
  visit(QueryField<bool>{
      &Q::first_pose, "first_pose", "first poses", "--first-pose",
      "Also report the first pose that touches each colliding point, counted from 0",
      "Whether the first pose that touches each colliding point is asked for.", 2});
  visit(QueryField<double>{
      &Q::clearance, "clearance", "clearance", "--clearance",
      "Also report the least distance, and its pose, of every point closer than this, for "
      "example 0.5; engine sweep only",
      "The distance of every point that is closer than this is asked for too; metres; 0: of none.",
      2});
  visit(QueryField<double>{
      &Q::profile, "profile", "profile", "--profile",
      "Also report for every pose the least distance below this, and its point, for example 0.5; "
      "engine sweep only",
      "The least distance at every pose is asked for, where it is below this; metres; 0: it is "
      "not.",
      3});
  visit(QueryField<bool>{
      &Q::between_poses, "between_poses", "motion", "--between-poses",
      "Move every model point on a straight segment from each pose to the next",
      "Whether model points move on straight segments from pose to pose, so that nothing between "
      "poses is missed.",
      2});
  visit(QueryField<bool>{
      &Q::seen, "seen", "seen space", "--seen",
      "Also find which places that the model sweeps no beam of the scanner passed through; the "
      "store has to know where the scanner stood",
      "Whether to find which places that the model sweeps no beam of the scanner passed through."});
  visit(QueryField<double>{
      &Q::seen_cube, "seen_cube", "cube of seen space", "--seen-cube",
      "Side of the cubes in which seen space is judged, for example 0.1 (default: 0.2 m)",
      "Side of the cubes in which seen space is judged; metres; 0: 0.2 m."});
  visit(QueryField<std::uint32_t>{
      &Q::seen_min, "seen_min", "least group of unseen cubes", "--seen-min",
      "Groups of fewer unseen cubes than this are counted, but not listed (default: 8)",
      "Groups of fewer unseen cubes than this are counted, but not listed."});
  using OptionalField = QueryField<std::optional<double>>;
  visit(OptionalField{
      &Q::error_scan, "error_scan", "error of the scan", "--error-scan",
      "Standard deviation of single scanned points on each axis, for example 5mm",
      "Standard deviation of single scanned points on each axis, metres; None: not given."});
  visit(OptionalField{
      &Q::error_registration, "error_registration", "error of the registration",
      "--error-registration",
      "Standard deviation of where whole scans lie on each axis, for example 1cm",
      "Standard deviation of where whole scans lie on each axis, metres; None: not given."});
  visit(OptionalField{
      &Q::error_pose, "error_pose", "error of the poses", "--error-pose",
      "Standard deviation of the vehicle's position on each axis, for example 2cm",
      "Standard deviation of the vehicle's position on each axis, metres; None: not given."});
  visit(OptionalField{
      &Q::error_angle, "error_angle", "error of the angles", "--error-angle",
      "Standard deviation of the vehicle's rotation about each axis, radians, or with deg, "
      "for example 0.1deg",
      "Standard deviation of the vehicle's rotation about each axis, radians; None: not "
      "given.",
      0, OptionalField::Unit::kRadians});
  visit(OptionalField{
      &Q::error_model, "error_model", "error of the model", "--error-model",
      "No place of the true vehicle is farther than this from its model, for example 1cm",
      "No place of the true vehicle is farther than this from its model, metres; None: not "
      "given."});
  visit(QueryField<double>{&Q::sigmas, "sigmas", "number of standard deviations", "--sigmas",
                           "How many standard deviations the error budget counts (default: 3)",
                           "How many standard deviations the error budget counts.", 0,
                           QueryField<double>::Unit::kNone});
  visit(QueryField<double>{
      &Q::gap, "gap", "gap", "--gap",
      "Points at most this far apart hang together when the error budget decides about a conflict "
      "(default: 0.3 m)",
      "Points at most this far apart hang together when the error budget decides about a conflict; "
      "metres; 0: 0.3 m. Of a result with a budget, the length that was used."});
}

/// Calls visit(field) for each parameter that is a list, of points that are left out of the search.
template <typename Visit>
void for_each_list_field(Visit visit) {
  using Q = QueryParameters;
  visit(QueryField<std::vector<std::uint8_t>>{
      &Q::ignore_classes, "ignore_classes", "ignored classes", "--ignore-class",
      "Leave points of these classes out of the search, for example 2,7 or 3-5; the store "
      "has to have classes",
      "The numbers of the classes whose points are left out of the search, such as [2] for the "
      "ground."});
  visit(QueryField<std::vector<Box>>{
      &Q::ignore_boxes, "ignore_boxes", "ignored boxes", "--ignore-box",
      "Leave points in this box out of the search: its least and its greatest x, y and z, in "
      "the environment's coordinates; may be given several times",
      "The boxes whose points are left out of the search, in the environment's coordinates: a list "
      "of Box."});
}

template <typename Visit>
void for_each_field(Visit visit) {
  for_each_value_field(visit);
  for_each_list_field(visit);
}

}  // namespace clearway
