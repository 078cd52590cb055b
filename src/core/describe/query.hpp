#pragma once

#include <tuple>

#include "clearway/query.hpp"
#include "core/describe/field.hpp"
#include "core/describe/selection.hpp"

namespace clearway {

/// The parameters of a query that are one value, in the order in which results keep them.
inline constexpr std::tuple kQueryValues{
    Field{.member = &QueryParameters::radius,
          .key = "radius",
          .topic = "radius",
          .option = "--radius",
          .group = OptionGroup::kInputs,
          .help = "Search radius in metres, for example 0.1, or with a unit, for example 10cm",
          .doc = "A point strictly closer to the model than this collides; metres, above 0.",
          .is_required = true,
          .is_always_listed = true,
          .is_in_campaigns = false},
    Field{.member = &QueryParameters::first_pose,
          .key = "first_pose",
          .topic = "first poses",
          .option = "--first-pose",
          .group = OptionGroup::kQuestion,
          .help = "Also report the first pose that touches each colliding point, counted from 0",
          .doc = "Whether the first pose that touches each colliding point is asked for.",
          .is_always_listed = true},
    Field{.member = &QueryParameters::clearance,
          .key = "clearance",
          .topic = "clearance",
          .option = "--clearance",
          .group = OptionGroup::kQuestion,
          .help = "Also report the least distance, and its pose, of every point closer than this, "
                  "for example 0.5; engine sweep only",
          .doc =
              "The distance of every point that is closer than this is asked for too; metres; 0: "
              "of none.",
          .is_always_listed = true},
    Field{.member = &QueryParameters::profile,
          .key = "profile",
          .topic = "profile",
          .option = "--profile",
          .group = OptionGroup::kQuestion,
          .help = "Also report for every pose the least distance below this, and its point, for "
                  "example 0.5; engine sweep only",
          .doc =
              "The least distance at every pose is asked for, where it is below this; metres; 0: "
              "it is not.",
          .is_always_listed = true},
    Field{.member = &QueryParameters::floor,
          .key = "floor",
          .topic = "floor",
          .option = "--floor",
          .group = OptionGroup::kQuestion,
          .help =
              "Judge only what lies at this height of the vehicle's frame or above, for example "
              "0.25, so that the ground under the wheels does not collide",
          .doc = "Height in each body's frame, metres: a point counts at a pose only if it lies at "
                 "this height or above, seen from the body there; None: all points count.",
          .no = "none",
          .range = FieldRange::kAny},
    Field{.member = &QueryParameters::depth,
          .key = "depth",
          .topic = "depth",
          .option = "--depth",
          .group = OptionGroup::kQuestion,
          .help = "Also report the distance of every colliding point to the nearest free point of "
                  "the scans, an estimate of how deep it is inside a model of points",
          .doc = "Whether to find for each colliding point the nearest point that neither collides "
                 "nor is ignored; its distance estimates how deep the point is inside the model.",
          .is_kept_if_set = true},
    Field{.member = &QueryParameters::between_poses,
          .key = "between_poses",
          .topic = "motion",
          .option = "--between-poses",
          .group = OptionGroup::kQuestion,
          .help = "Move every model point on a straight segment from each pose to the next",
          .doc =
              "Whether model points move on straight segments from pose to pose, so that nothing "
              "between poses is missed.",
          .yes = "between poses",
          .no = "at poses only",
          .is_always_listed = true},
    Field{.member = &QueryParameters::seen,
          .key = "seen",
          .topic = "seen space",
          .option = "--seen",
          .group = OptionGroup::kCertainty,
          .help = "Also find which places that the model sweeps no beam of the scanner passed "
                  "through; the store has to know where the scanner stood",
          .doc = "Whether to find which places that the model sweeps no beam of the scanner passed "
                 "through."},
    kSeenCube<QueryParameters>,
    Field{.member = &QueryParameters::seen_min,
          .key = "seen_min",
          .topic = "least group of unseen cubes",
          .option = "--seen-min",
          .group = OptionGroup::kCertainty,
          .help = "Groups of fewer unseen cubes than this are counted, but not listed",
          .usual = "8",
          .doc = "Groups of fewer unseen cubes than this are counted, but not listed.",
          .least = 1,
          .most = 1e9},
    Field{.member = &QueryParameters::error_scan,
          .key = "error_scan",
          .topic = "error of the scan",
          .option = "--error-scan",
          .group = OptionGroup::kCertainty,
          .help = "Standard deviation of single scanned points on each axis, for example 5mm",
          .doc = "Standard deviation of single scanned points on each axis, metres; None: not "
                 "given.",
          .no = "not given",
          .range = FieldRange::kFromZero},
    Field{.member = &QueryParameters::error_registration,
          .key = "error_registration",
          .topic = "error of the registration",
          .option = "--error-registration",
          .group = OptionGroup::kCertainty,
          .help = "Standard deviation of where whole scans lie on each axis, for example 1cm",
          .doc = "Standard deviation of where whole scans lie on each axis, metres; None: not "
                 "given.",
          .no = "not given",
          .range = FieldRange::kFromZero},
    Field{.member = &QueryParameters::error_pose,
          .key = "error_pose",
          .topic = "error of the poses",
          .option = "--error-pose",
          .group = OptionGroup::kCertainty,
          .help = "Standard deviation of the vehicle's position on each axis, for example 2cm",
          .doc = "Standard deviation of the vehicle's position on each axis, metres; None: not "
                 "given.",
          .no = "not given",
          .range = FieldRange::kFromZero},
    Field{.member = &QueryParameters::error_angle,
          .key = "error_angle",
          .topic = "error of the angles",
          .option = "--error-angle",
          .group = OptionGroup::kCertainty,
          .help = "Standard deviation of the vehicle's rotation about each axis, radians, or with "
                  "deg, for example 0.1deg",
          .doc = "Standard deviation of the vehicle's rotation about each axis, radians; None: not "
                 "given.",
          .no = "not given",
          .unit = FieldUnit::kRadians,
          .range = FieldRange::kFromZero},
    Field{
        .member = &QueryParameters::error_model,
        .key = "error_model",
        .topic = "error of the model",
        .option = "--error-model",
        .group = OptionGroup::kCertainty,
        .help = "No place of the true vehicle is farther than this from its model, for example 1cm",
        .doc = "No place of the true vehicle is farther than this from its model, metres; None: "
               "not given.",
        .no = "not given",
        .range = FieldRange::kFromZero},
    Field{.member = &QueryParameters::sigmas,
          .key = "sigmas",
          .topic = "number of standard deviations",
          .option = "--sigmas",
          .group = OptionGroup::kCertainty,
          .help = "How many standard deviations the error budget counts",
          .usual = "3",
          .doc = "How many standard deviations the error budget counts.",
          .unit = FieldUnit::kNone,
          .is_of_budget = true},
    Field{
        .member = &QueryParameters::gap,
        .key = "gap",
        .topic = "gap",
        .option = "--gap",
        .group = OptionGroup::kCertainty,
        .help = "Points at most this far apart hang together when the error budget decides about a "
                "conflict",
        .usual = "0.3 m",
        .doc = "Points at most this far apart hang together when the error budget decides about a "
               "conflict; metres; 0: 0.3 m. Of a result with a budget, the length that was used.",
        .is_of_budget = true}};

/// All parameters of a query.
inline constexpr std::tuple kQueryFields =
    std::tuple_cat(kQueryValues, kIgnoredFields<QueryParameters>);

/// Whether lists of a query's parameters name this one: some always, those of an error budget where
/// there is one, since the answer then depends on them also where they are the default, and others
/// where they are not the default.
template <typename Value>
bool is_listed(const Field<QueryParameters, Value>& field, const QueryParameters& query) {
  if (field.is_always_listed) return true;
  return field.is_of_budget ? query.has_budget() : !field.is_default(query);
}

}  // namespace clearway
