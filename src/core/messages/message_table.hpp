#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "clearway/answer.hpp"

namespace clearway {

/// Whether a message with some code is a note, a warning, or one or the other.
enum class Severities : unsigned { kNote = 1, kWarning = 2, kEither = 3 };

/// What a message is about, which is the section of the guide that explains it.
enum class Subject { kScans, kModels, kTrajectories, kQueries, kFindings };

/// What a search that gave a warning may have missed.
enum class Missing {
  kNothing,
  kPlace,  ///< points, because the model may not have been where they are
  kScan    ///< points that the scan lacks, so that what stood there may stand there still
};

/// What a warning means for an answer. A search that gave a warning with a doubt or with something
/// missing may have missed points; other warnings leave the answer as it is. A warning that a store
/// repeats from its conversion has the effect of its code without the prefix.
struct MessageEffect {
  Doubt doubt = Doubt::kNone;
  Missing missing = Missing::kNothing;
  /// Whether the warning concerns the vehicle and not a single body: a roof is always above the
  /// ground, and in a cutting a bogie has a wall on its own side only.
  bool of_vehicle = false;
};

/// All that is known of the messages with one code.
struct MessageKind {
  std::string_view code;
  Severities severities;
  Subject subject;
  std::string_view sentence;  ///< Markdown, for the guide
  MessageEffect effect = {};
};

namespace message_table {

using enum Severities;
using enum Subject;

/// The messages, by subject and code. docs/guide/warnings.md is made from this table.
inline constexpr auto kMessageKinds = std::to_array<MessageKind>({
    {"absent-points", kWarning, kScans,
     "More than 99 % of the records hold no point, such as beams without a return."},
    {"column-names", kWarning, kScans,
     "The columns that a comment names are not those that the lines have, so the first three "
     "are used."},
    {"crs-ignored", kWarning, kScans,
     "`--ignore-crs` let something pass that is refused otherwise: degrees, different units, or "
     "a system that is not read. The message names it."},
    {"crs-not-read", kWarning, kScans,
     "A file says something of its coordinate reference system or unit that is not understood. "
     "The message names it, and says what is taken instead."},
    {"cut-off",
     kWarning,
     kScans,
     "Points of a LAS, LAZ or E57 file are at the lowest or the greatest of the integers that a "
     "coordinate can have, where a program cut off what lies beyond. The message gives their "
     "number for each axis.",
     {.doubt = Doubt::kQuestion}},
    {"cut-text",
     kWarning,
     kScans,
     "The last line of a text file lacks values, so the file may be cut.",
     {.doubt = Doubt::kQuestion}},
    {"declared-bounds",
     kWarning,
     kScans,
     "A file has points inside of the bounds that it declares and others far beyond them, as where "
     "records are damaged.",
     {.doubt = Doubt::kQuestion}},
    {"degrees",
     kWarning,
     kScans,
     "The scan declares that its coordinates are in degrees, and distances in degrees mean "
     "nothing.",
     {.doubt = Doubt::kQuestion}},
    {"e57-unit", kWarning, kScans,
     "The coordinate reference system is in feet, while E57 has metres."},
    {"far-apart", kWarning, kScans, "One file lies far from all others."},
    {"feet", kEither, kScans,
     "The environment is in feet, so lengths, models and trajectories that name no unit are "
     "taken in feet too. It is a note for a query where all of them name their units."},
    {"floating-point-rounded", kEither, kScans,
     "Files with floating-point coordinates were rounded to the steps of the others. It is a "
     "warning above 1 mm."},
    {"gps-times-contradict", kWarning, kScans,
     "With `--origins-path`, GPS times of points cannot be what bit 0 of their file's global "
     "encoding says: seconds of the GPS week, or adjusted standard GPS time. They are compared "
     "with the path as they are."},
    {"gps-times-not-finite", kWarning, kScans,
     "With `--origins-path`, points have a GPS time that is not a finite number, and so no "
     "origin."},
    {"las-count", kWarning, kScans,
     "A LAS file on standard input holds more points than it declares, and all were read."},
    {"left-out", kEither, kScans,
     "A folder holds files or folders that are not read. It is a warning where a folder holds "
     "point files, or a file looks like points: the environment lacks them."},
    {"like-degrees", kWarning, kScans,
     "The coordinates look like longitudes and latitudes: no unit is named, and the heights span "
     "at least 50 times what the coordinates span themselves."},
    {"lost-digits", kWarning, kScans,
     "The coordinates of an axis of a scan, or the positions of a path, come in a coarse step, "
     "such as half a metre, because rounding or single floats lost the rest."},
    {"map-scale", kWarning, kScans,
     "Lengths on the map of the scans, or somewhere on the path, differ by more than 0.2 % from "
     "those on the ground. For scans the message has the scale at their middle along the worst "
     "direction, and by area."},
    {"map-scale-unknown", kWarning, kScans,
     "The scale of the map at the middle of the scans cannot be computed, for example because "
     "they do not lie where the map is."},
    {"mesh-faces", kWarning, kScans,
     "The file is a mesh, and only its vertices are taken as a scan."},
    {"model-among-scans", kNote, kScans,
     "`clearway check` leaves a file of the vehicle out of the scans, among which it lies."},
    {"more-warnings", kWarning, kScans,
     "The conversion gave more warnings than the 64 that a store keeps."},
    {"named-otherwise", kNote, kScans,
     "A text is read as PTX or PTS, although its name says otherwise."},
    {"near-store", kNote, kScans,
     "The store holds only points near a path (`convert --near`), and the checks that look farther "
     "are not made. What is left out never changes an answer: questions that reach so far are "
     "refused."},
    {"no-crs", kNote, kScans,
     "Some files name no coordinate reference system, and go with the others."},
    {"no-gps-times", kWarning, kScans,
     "With `--origins-path`, some inputs have no GPS times, so their points have no origin."},
    {"no-points",
     kWarning,
     kScans,
     "A file, or the whole store, has no point. Nothing can collide with such a store.",
     {.doubt = Doubt::kQuestion}},
    {"non-finite-points", kWarning, kScans,
     "Points with NaN or infinite coordinates are left out."},
    {"origins-at-zero", kWarning, kScans,
     "All origins are at 0 0 0, although there are several scans, or all points are more than "
     "100 m away from there. That is wrong for scans that were moved or merged."},
    {"origins-far", kWarning, kScans,
     "Origins are more than 1 km away from all points. They may be in other coordinates."},
    {"origins-path-gap", kWarning, kScans,
     "With `--origins-path`, points are from before the first pose, from after the last one, or "
     "from between poses more than 1 s apart, and have no origin."},
    {"other-crs", kWarning, kScans,
     "The scans have different coordinate reference systems, by their well-known texts or the "
     "codes of their GeoTIFF keys, or it is not known whether they are the same. The "
     "coordinates are merged as they are, so transform the scans to one system first."},
    {"other-size", kWarning, kScans,
     "One file is many times larger than another, so its unit may be another."},
    {"other-unit", kWarning, kScans,
     "The header names another unit, but the numbers count as they are because `--columns` was "
     "given."},
    {"outside-bounds", kWarning, kScans,
     "All points of a file lie far outside of the bounds that it declares, as where its header was "
     "not written anew when the scan was moved."},
    {"padded-cells", kWarning, kScans, "A regular layout leaves most of its cells empty."},
    {"pcd-viewpoint", kWarning, kScans,
     "A PCD file has a VIEWPOINT, which is not applied. If the points are in the sensor's "
     "frame, apply it first."},
    {"points-without-origin", kWarning, kScans, "Some points have an origin and others have none."},
    {"poses-not-applied", kWarning, kScans,
     "Files with poses lie beside scans that are not of 3DTK."},
    {"same-place", kWarning, kScans, "Many points are at the same place."},
    {"same-scan", kWarning, kScans, "Two files hold the same points."},
    {"scan-axes-contradict", kWarning, kScans,
     "Position and axes of a PTX scan contradict its matrix, which is applied."},
    {"scan-not-registered",
     kWarning,
     kScans,
     "A 3DTK scan has `.pose` only, while others have `.frames`.",
     {.doubt = Doubt::kQuestion}},
    {"scan-not-rigid", kWarning, kScans, "The matrix of a PTX scan scales, shears or mirrors."},
    {"scan-placed", kNote, kScans, "The note says where the pose of a scan of 3DTK comes from."},
    {"scan-without-pose", kWarning, kScans,
     "A single 3DTK scan has no pose, so it stays at its own origin."},
    {"skipped-files", kWarning, kScans, "`--skip-unreadable` left files out."},
    {"units-contradict", kWarning, kScans,
     "A file names two units of length, for example in its GeoTIFF keys and its well-known "
     "text, and the message says which one is used."},
    {"withheld-points", kEither, kScans,
     "Points of LAS or LAZ have the flag *withheld* and are left out as deleted. It is a "
     "warning of `convert` where they are more than 1 %, because a filter may have taken a wire "
     "or a sign for noise. `--keep-withheld` keeps them."},
    {"half-outline", kWarning, kModels,
     "All corners of an outline are on one side of the middle, and an edge runs along it, as in "
     "one half of a symmetric outline. The other side is taken to be free. `--mirror` completes "
     "a half."},
    {"loose-vertices", kWarning, kModels,
     "Vertices of a mesh belong to no face, line or point and are left out, so a mast that they "
     "are meant to show is missing."},
    {"mesh-bent-faces", kWarning, kModels,
     "Faces with more than three corners are not flat, but bend by more than the spacing."},
    {"mesh-crossing-faces", kWarning, kModels,
     "The outline of a face crosses itself, so it is not certain what it means."},
    {"two-feet", kWarning, kModels,
     "The model or the path is in the international foot and the environment in the US survey "
     "foot, or the reverse. If the file is in the environment's foot, give its unit as `ft`."},
    {"unit-assumed", kWarning, kModels,
     "The model, the path or a length is in a unit other than the metre, and the environment "
     "names no unit, so metres are assumed for it. If that is right, convert the scan again "
     "with `--unit m`."},
    {"withheld-model-points", kWarning, kModels,
     "Points of a model in LAS or LAZ have the flag *withheld* and are left out as deleted."},
    {"alignment-crs", kWarning, kTrajectories,
     "The alignment and the environment are in different coordinate systems, by their EPSG "
     "codes, or the alignment names two. The coordinates were not converted."},
    {"alignment-feet", kWarning, kTrajectories,
     "The coordinates of an alignment are in feet, and are so large that the international and "
     "the US survey foot put them more than half a millimetre apart."},
    {"alignment-kink", kWarning, kTrajectories,
     "The direction of an alignment jumps by more than 0.001 radians between two elements, so "
     "the vehicle turns on the spot there."},
    {"alignment-length", kWarning, kTrajectories,
     "The elements of an alignment are together longer or shorter than the file declares, by "
     "more than 1 mm. Some may be missing."},
    {"alignment-stations", kWarning, kTrajectories,
     "Elements of an alignment declare stations that differ by more than 1 mm from the sum of "
     "the lengths before them, which counts."},
    {"angle-frame", kNote, kTrajectories, "The note says how roll, pitch and heading are counted."},
    {"angles-in-degrees", kNote, kTrajectories, "Angles were taken as degrees."},
    {"body-far", kWarning, kTrajectories,
     "The station of a body, or its pivots, are more than three times the length of the longest "
     "body away from the rest of the vehicle, as where a sign or a unit was mistyped."},
    {"body-folded", kWarning, kTrajectories,
     "The path turns back between the two pivots of a body."},
    {"body-off-path",
     kEither,
     kTrajectories,
     "A body has no pose where its station or pivot is off the path, or where none was given. "
     "It is a note where that is so at the ends of the path only, and on at most half of it, "
     "because the verdict and the report say what was searched.",
     {.doubt = Doubt::kStretch}},
    {"body-transient", kEither, kTrajectories,
     "A towed body begins in line with the body that tows it, which matters until the hitch has "
     "gone three times as far as from the hitch to the axle. It is a warning where the body "
     "that tows it turns by more than 5 degrees meanwhile, because the path then begins in a "
     "bend, and where the towed body is there is a guess."},
    {"body-turned", kWarning, kTrajectories,
     "The path is driven against its x axis, or its poses have axes other than x forward and z "
     "up. Of a towed body, the hitch leaves at more than 60 degrees from the x axis of the body "
     "that tows it."},
    {"body-undefined",
     kWarning,
     kTrajectories,
     "A body has no pose where its pivots are at the same place, or above each other.",
     {.doubt = Doubt::kStretch}},
    {"cant-ends", kWarning, kTrajectories,
     "The cant of an alignment is given for a part of the poses only, and its last value, which "
     "is not 0, was kept beyond."},
    {"cant-rails", kNote, kTrajectories,
     "A line has cant, and no distance between the rails was given, so that of standard gauge "
     "was taken, 1.5 m."},
    {"cant-rotation", kWarning, kTrajectories,
     "The cant does not say about which rail it turns the track, so the inner rail was taken."},
    {"cant-side", kWarning, kTrajectories,
     "In most curves of a path the outer rail is more than 50 mm lower than the inner one, or "
     "the model leans outwards as much, so cant or roll may have the wrong sign."},
    {"cant-transition", kWarning, kTrajectories,
     "A station of cant names a `transitionType` where no ramp begins, while the ramp that ends "
     "there has another one. A type was taken for the ramp behind its station."},
    {"cant-unit", kWarning, kTrajectories,
     "The greatest cant is below 2 mm or above 300 mm, so it may be in metres instead of "
     "millimetres, or the reverse."},
    {"datum-accuracy", kEither, kTrajectories,
     "The message says how exact the change of datum is. It is a warning where that is above 1 "
     "m or not known."},
    {"ellipsoidal-heights", kWarning, kTrajectories,
     "Heights are ellipsoidal, and no ellipsoidal heights were asked for."},
    {"forward-axis", kWarning, kTrajectories,
     "The motion is along an axis of the poses' frame other than x."},
    {"frames-not-poses", kNote, kTrajectories,
     "In a 3DTK folder the `.frames` files are used, and not the `.pose` files."},
    {"ground-ends", kWarning, kTrajectories,
     "No ground was found at the ends of a line, by up to 5 m, so the poses begin later or end "
     "earlier."},
    {"ground-leans", kWarning, kTrajectories,
     "On the ground that was found, the vehicle would lean by more than 8.6 degrees, as where a "
     "parked car under one wheel hides the ground."},
    {"heights-converted", kNote, kTrajectories,
     "Heights of a path were converted to those of the map."},
    {"line-crs", kWarning, kTrajectories,
     "The line and the environment are in different coordinate systems, by their EPSG codes. "
     "The coordinates were not converted."},
    {"line-curved", kEither, kTrajectories,
     "Between its vertices the path is a smooth curve, which leaves the straight legs by more "
     "than 1 cm. It is a warning above 0.1 m."},
    {"line-degrees", kWarning, kTrajectories,
     "The coordinates of a line may be longitude and latitude instead of lengths."},
    {"line-others", kNote, kTrajectories,
     "A file of GeoJSON holds points or polygons beside its line, which were left out."},
    {"line-rounded", kNote, kTrajectories,
     "Vertices of a line got arcs. The note says how far the path passes the sharpest corner on "
     "its inside."},
    {"line-stations", kWarning, kTrajectories,
     "The stations of a line span a length that differs by more than 5 % from its own, so they "
     "may be in another unit."},
    {"line-steep", kWarning, kTrajectories,
     "A line climbs or falls by more than 30 %, so its column z may not be the height."},
    {"map-distorts", kWarning, kTrajectories,
     "The map does not keep angles, so a rigid model does not fit it."},
    {"map-projection", kNote, kTrajectories,
     "The note says which map the positions are in, with its north and its scale."},
    {"map-unit", kEither, kTrajectories,
     "The map is not in metres, so neither may model and radius be. It is a warning where the "
     "environment is in another unit."},
    {"model-frame", kNote, kTrajectories, "The note says which frame the model must have."},
    {"no-cant", kNote, kTrajectories,
     "The alignment or the line has no cant, so options of cant change nothing."},
    {"on-ground", kNote, kTrajectories,
     "Height and roll are those of the ground in a scan. The note says at how many places it "
     "was found. Under a parked car the path is about 0.3 m too high."},
    {"path-outside-scan", kWarning, kTrajectories, "No pose lies in the box of the store."},
    {"poses-inverse",
     kWarning,
     kTrajectories,
     "With inverse poses the model would move straight ahead.",
     {.doubt = Doubt::kQuestion}},
    {"profile-shorter", kWarning, kTrajectories,
     "The profile of an alignment begins after the first station that was wanted, or ends "
     "before the last one, and so do the poses."},
    {"quaternion-order",
     kWarning,
     kTrajectories,
     "The model tilts less with another order of the quaternion.",
     {.doubt = Doubt::kQuestion}},
    {"rotation-missing", kWarning, kTrajectories, "The path turns, but no pose turns the model."},
    {"rotation-too-small",
     kWarning,
     kTrajectories,
     "The poses turn far less than the path, so angles may be radians.",
     {.doubt = Doubt::kQuestion}},
    {"station-equations", kWarning, kTrajectories,
     "The file renames stations. All stations that are given and written are internal ones, "
     "which run on evenly."},
    {"station-order", kWarning, kTrajectories,
     "The stations of a line do not run on in one direction."},
    {"steps-above-radius", kWarning, kTrajectories,
     "Some steps move the model farther than the radius."},
    {"superelevation", kWarning, kTrajectories,
     "The alignment is that of a road with superelevation, which is not read, so the poses are "
     "level across."},
    {"time-order", kWarning, kTrajectories,
     "Some poses have an earlier time than the pose before them. The poses are taken in the "
     "order of the file."},
    {"trajectory-jump", kEither, kTrajectories,
     "A step is more than five times as long as the median of those around it, and longer than "
     "the radius (0.1 m where no radius is given), so poses may be missing there. Complete the "
     "recording, or split the trajectory there. `run`, `report` and the commands of "
     "`trajectory` judge it. It is a note where equal jumps come after equal numbers of poses, "
     "as between the rows of a grid."},
    {"trajectory-unit", kNote, kTrajectories,
     "Positions were converted to metres or to the unit of the environment, or are in that unit "
     "already."},
    {"turns-against-path",
     kWarning,
     kTrajectories,
     "The model turns left where the path turns right.",
     {.doubt = Doubt::kQuestion}},
    {"unread-columns", kEither, kTrajectories,
     "Columns of a table of poses, or of a line, are not read. It is a warning where the name "
     "of one says that it is a cant, or for a line a roll or the height that it lacks."},
    {"up-axis", kWarning, kTrajectories, "An axis other than z points up, as in a camera's frame."},
    {"upside-down", kWarning, kTrajectories, "The model's z axis points down."},
    {"absent-class", kWarning, kQueries, "`--ignore-class` names classes that no point has."},
    {"all-ignored",
     kWarning,
     kQueries,
     "All points of the environment are ignored, so nothing is searched.",
     {.doubt = Doubt::kQuestion}},
    {"beams-without-origin", kWarning, kQueries,
     "With `--seen`, some points do not say where their scanner stood, so that their beams show "
     "nothing."},
    {"below-ground",
     kWarning,
     kQueries,
     "On most of the path the model reaches more than 0.3 m below the ground. Its file may have y "
     "up, or its origin in its middle, or the path may be too low. Without the ground, or with a "
     "floor, the answer can be clear although no vehicle stands there.",
     {.doubt = Doubt::kQuestion, .missing = Missing::kPlace}},
    {"coarse-digits",
     kWarning,
     kQueries,
     "The coordinates of the scan come in steps that are not smaller than the radius, so that "
     "points may be farther from where they were measured than the radius. The message names the "
     "axes and their steps.",
     {.doubt = Doubt::kQuestion}},
    {"coarse-scan",
     kWarning,
     kQueries,
     "The points of the scan are so far apart that the model, or what stands in its way, fits "
     "between them.",
     {.missing = Missing::kScan}},
    {"drives-backwards", kNote, kQueries,
     "The model moves against its x axis along the whole path."},
    {"empty-box", kWarning, kQueries, "A box of `--ignore-box` holds no point."},
    {"errors-exceed-margin", kNote, kQueries,
     "The errors that count against a conflict are at least as large as the radius, so that "
     "only points inside a solid could be a certain conflict. See [How sure is "
     "clear?](certainty.md)."},
    {"few-sigmas", kWarning, kQueries,
     "`--sigmas` is below 1, so that most errors exceed what the error budget counts."},
    {"fine-radius", kWarning, kQueries,
     "The radius is only a few steps of the stored coordinates."},
    {"flat-model", kWarning, kQueries, "The model has no length in its direction of travel."},
    {"flat-scan", kWarning, kQueries, "The environment has no height, or no width."},
    {"floats",
     kWarning,
     kQueries,
     "The model is above the ground on most of the path, or is at least 0.5 m higher above the "
     "ground on a stretch of it than elsewhere.",
     {.doubt = Doubt::kStretch, .of_vehicle = true}},
    {"floor-axis", kWarning, kQueries,
     "The model's z axis is more than 45 degrees from the scan's up at most poses, so a floor does "
     "not leave out the ground."},
    {"floor-high", kWarning, kQueries,
     "The floor is more than 0.5 m and a third of the model's height above its lowest part, as "
     "where "
     "the model's origin is in its middle. A floor above the whole model is refused."},
    {"ground-collides", kNote, kQueries,
     "At more than half of 16 poses points under the model, in its lowest 0.3 m, are within the "
     "radius, as the ground is under wheels. It is looked for before the search; the message names "
     "the `--floor` that leaves them out."},
    {"ignored-collide", kWarning, kQueries,
     "More ignored points would collide than searched ones do. There is no such warning if the "
     "vehicle has a floor. This is known only after the search, so `--strict` "
     "does not count it. Of a section it is about cells that ignored points alone would block, "
     "and `--strict` counts it."},
    {"ignored-high", kWarning, kQueries,
     "Ignored points would collide more than 0.5 m above the model's lowest point, where no "
     "ground is. This is known only after the search, so `--strict` does not count it. Of a "
     "section it is about cells that ignored points alone would block, and `--strict` counts it."},
    {"inside-model", kWarning, kQueries,
     "Points lie inside the model at the first pose and do not touch it, because only the "
     "surface is tested. With `--model-as solid` points in closed parts collide."},
    {"journal-left", kWarning, kQueries,
     "The result is complete, but its journal could not be removed."},
    {"large-cubes", kWarning, kQueries,
     "With `--seen`, the cubes are larger than twice the distance at which their middles count "
     "as swept (the radius, with an error budget and the errors), so that thin parts of the "
     "vehicle can pass between the middles. Give a smaller `--seen-cube`."},
    {"large-steps", kEither, kQueries,
     "The model moves farther than the radius from one pose to the next. With `--between-poses` "
     "it warns that the true motion can leave the straight way between two poses by more than "
     "the radius, or notes that it can leave it by more than a tenth of the radius. More poses "
     "of the recording help, or [resampling](choosing.md#poses). Of a section at poses it warns "
     "that a step is longer than the load, or moves it across by more than the margin and 0.15 "
     "m, as in a bend, so that something can reach deeper into it between two poses than at "
     "either. It notes more than two cells."},
    {"leans", kWarning, kQueries,
     "The model leans to one side by the same angle on its whole path, as with a scanner that "
     "is mounted askew."},
    {"leaves-scan",
     kWarning,
     kQueries,
     "Parts of the path are not scanned, so the run is undecided there.",
     {.doubt = Doubt::kStretch, .missing = Missing::kScan}},
    {"long-beams", kWarning, kQueries,
     "With `--seen`, some beams are longer than 1 km, or than 2^30 steps of the stored "
     "coordinates, and are left out. The origins may be those of other scans."},
    {"mirrored-poses",
     kWarning,
     kQueries,
     "The poses mirror the model.",
     {.doubt = Doubt::kQuestion}},
    {"model-is-environment",
     kWarning,
     kQueries,
     "The model has as many points as the environment, and the same box.",
     {.doubt = Doubt::kQuestion}},
    {"model-origin", kWarning, kQueries, "The model lies far from the origin of its frame."},
    {"model-size", kWarning, kQueries, "The model is implausibly large or small."},
    {"model-spacing", kWarning, kQueries, "Model points are farther apart than the radius."},
    {"model-unit",
     kWarning,
     kQueries,
     "The shortest side of the model is above 30 m, or its longest one below 1 cm, so its unit is "
     "probably another one.",
     {.doubt = Doubt::kQuestion}},
    {"most-ignored", kWarning, kQueries,
     "Less than 1 % of the points of the environment are left to be searched."},
    {"motion-exceeds-cell", kWarning, kQueries,
     "Between two poses the load of a section moves across by more than a cell, and a check "
     "keeps half of that motion as a distance."},
    {"no-poses",
     kWarning,
     kQueries,
     "The trajectory, or a body, has no pose, so that nothing can collide.",
     {.doubt = Doubt::kQuestion}},
    {"nothing-below",
     kWarning,
     kQueries,
     "Nothing was scanned below the model on most of the path or on a stretch of it, because "
     "the scan has a hole, or a part of it has another height.",
     {.doubt = Doubt::kStretch, .missing = Missing::kScan, .of_vehicle = true}},
    {"nothing-beside",
     kWarning,
     kQueries,
     "Nothing was scanned beside the model at its height on most of the path, or on a stretch "
     "of it.",
     {.missing = Missing::kScan, .of_vehicle = true}},
    {"nothing-blocked", kWarning, kQueries,
     "No point blocks a cell of a section: it is free, or nothing was scanned where the load "
     "passes."},
    {"nothing-swept",
     kWarning,
     kQueries,
     "With `--seen`, the vehicle sweeps the middle of no cube, so nothing is known of what was "
     "scanned. This is known only after the search, so `--strict` does not count it.",
     {.doubt = Doubt::kQuestion}},
    {"one-side",
     kWarning,
     kQueries,
     "Only one side of the path was scanned, or of a stretch of it. The number `side` is 1 "
     "where the left side is missing, and -1 where the right one is. If both are missing, on "
     "different stretches, there are two warnings.",
     {.missing = Missing::kScan, .of_vehicle = true}},
    {"open-model", kWarning, kQueries,
     "Seen in its direction of travel, the model has large holes, through which things can pass."},
    {"out-of-reach",
     kWarning,
     kQueries,
     "Nothing was scanned near the path.",
     {.doubt = Doubt::kQuestion, .missing = Missing::kScan}},
    {"radius-size", kWarning, kQueries, "The radius is implausibly large."},
    {"rotations", kWarning, kQueries, "The model does not move along one of its own axes."},
    {"same-body", kWarning, kQueries,
     "Bodies of a vehicle have the same model at the same poses, as a copied entry of its file "
     "has. Give each its own model or place."},
    {"scaled-poses", kWarning, kQueries, "The poses scale the model."},
    {"sideways", kWarning, kQueries,
     "The model moves across its longest side. `--forward` and `--up` [turn](inputs.md#turning) "
     "it."},
    {"single-precision", kWarning, kQueries,
     "The positions of the path, or the points of the model, were stored in single precision at "
     "coordinates where its steps are larger than a twentieth of the radius."},
    {"small-error-angle", kWarning, kQueries,
     "`--error-angle` is below 0.001 degrees, as where radians are given as degrees."},
    {"small-unseen", kWarning, kQueries,
     "With `--seen`, groups of fewer than `--seen-min` cubes were passed through by no beam; "
     "something small can be there. This is known only after the search, so `--strict` does not "
     "count it."},
    {"tilted", kWarning, kQueries, "The model's z axis does not point up."},
    {"tiny-path", kWarning, kQueries, "The whole path is shorter than a part of the model."},
    {"no-clearances", kWarning, kFindings,
     "The result has no clearances, so the table of stations has no distances. Run again with "
     "`--clearance`."},
    {"no-overthrow", kWarning, kFindings,
     "The path is none that a body can follow, for example because it mirrors the model by "
     "turns, so overthrow is not known."},
    {"one-long-conflict", kWarning, kFindings,
     "One group spans at least half of the path, as wheels on the ground do. `--floor` "
     "leaves the ground out."},
    {"searched-unknown", kWarning, kFindings,
     "Some bodies have no pose on a part of the path, and without `--vehicle` it is not known "
     "where, so no stretch is called clear."},
    {"sides-unknown", kWarning, kFindings,
     "For a vehicle, without `--vehicle`, the table of stations cannot say what is to the left, to "
     "the right and above."},
    {"unmatched-files", kNote, kFindings,
     "A pattern of a campaign leaves out files beside those that it matches, with the same "
     "ending or another one of the same kind."},
});

}  // namespace message_table

/// Prefix of the codes of a store's warnings where another command repeats them.
inline constexpr std::string_view kStorePrefix = "store-";

/// The place of a code in the table, or the number of its rows.
constexpr std::size_t place_of_message_kind(std::string_view code) {
  const auto& kinds = message_table::kMessageKinds;
  const auto found = std::ranges::find(kinds, code, &MessageKind::code);
  return static_cast<std::size_t>(found - kinds.begin());
}

/// The row with a code, or nullptr.
constexpr const MessageKind* find_message_kind(std::string_view code) {
  const auto& kinds = message_table::kMessageKinds;
  const std::size_t place = place_of_message_kind(code);
  return place == kinds.size() ? nullptr : &kinds[place];
}

/// What a warning with this code means for an answer, also where a store repeats it; nothing for an
/// unknown code.
constexpr MessageEffect effect_of(std::string_view code) {
  if (code.starts_with(kStorePrefix)) code.remove_prefix(kStorePrefix.size());
  const MessageKind* const kind = find_message_kind(code);
  return kind == nullptr ? MessageEffect() : kind->effect;
}

/// A code that the table has for messages of this severity. It is made of a literal, and another
/// literal does not compile.
template <Severities kNeeded>
class MessageCode {
 public:
  consteval MessageCode(const char* code) : code_(code) {  // NOLINT(google-explicit-constructor)
    // By its place: with sanitizers, gcc compares no address while it compiles.
    const auto& kinds = message_table::kMessageKinds;
    const std::size_t place = place_of_message_kind(code);
    const auto needed = static_cast<unsigned>(kNeeded);
    if (place == kinds.size() ||
        (static_cast<unsigned>(kinds[place].severities) & needed) != needed) {
      throw "the table of messages has no such code of this severity";
    }
  }

  constexpr std::string_view view() const { return code_; }

  friend bool operator==(std::string_view a, const MessageCode& b) { return a == b.code_; }

 private:
  std::string_view code_;
};

using NoteCode = MessageCode<Severities::kNote>;
using WarningCode = MessageCode<Severities::kWarning>;
using EitherCode = MessageCode<Severities::kEither>;

}  // namespace clearway
