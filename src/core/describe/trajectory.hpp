#pragma once

#include <array>
#include <tuple>

#include "clearway/alignment.hpp"
#include "clearway/trajectory.hpp"
#include "core/describe/field.hpp"

namespace clearway {

template <>
inline constexpr std::array kChoices<TrajectoryFormat>{
    Choice<TrajectoryFormat>{"auto", TrajectoryFormat::kAuto},
    Choice<TrajectoryFormat>{"matrix", TrajectoryFormat::kMatrix},
    Choice<TrajectoryFormat>{"tum", TrajectoryFormat::kTum},
    Choice<TrajectoryFormat>{"euroc", TrajectoryFormat::kEuroc},
    Choice<TrajectoryFormat>{"csv", TrajectoryFormat::kCsv},
    Choice<TrajectoryFormat>{"pose-xyzw", TrajectoryFormat::kPoseXyzw},
    Choice<TrajectoryFormat>{"pose-wxyz", TrajectoryFormat::kPoseWxyz},
    Choice<TrajectoryFormat>{"sbet", TrajectoryFormat::kSbet},
    Choice<TrajectoryFormat>{"3dtk-pose", TrajectoryFormat::kThreedtkPose},
    Choice<TrajectoryFormat>{"3dtk-frames", TrajectoryFormat::kThreedtkFrames}};
template <>
inline constexpr std::array kChoices<AngleUnit>{Choice<AngleUnit>{"declared", AngleUnit::kDeclared},
                                                Choice<AngleUnit>{"deg", AngleUnit::kDegrees},
                                                Choice<AngleUnit>{"rad", AngleUnit::kRadians}};
template <>
inline constexpr std::array kChoices<AngleFrame>{
    Choice<AngleFrame>{"declared", AngleFrame::kDeclared},
    Choice<AngleFrame>{"ned", AngleFrame::kNed}, Choice<AngleFrame>{"enu", AngleFrame::kEnu}};

template <>
inline constexpr std::array kChoices<CantLine>{
    Choice<CantLine>{"file", CantLine::kFile},
    Choice<CantLine>{"none", CantLine::kNone},
    Choice<CantLine>{"center", CantLine::kCenter},
    Choice<CantLine>{"inside-rail", CantLine::kInsideRail},
    Choice<CantLine>{"outside-rail", CantLine::kOutsideRail},
    Choice<CantLine>{"left-rail", CantLine::kLeftRail},
    Choice<CantLine>{"right-rail", CantLine::kRightRail}};
template <>
inline constexpr std::array kChoices<AxisOrder>{
    Choice<AxisOrder>{"ne", AxisOrder::kNorthingEasting},
    Choice<AxisOrder>{"en", AxisOrder::kEastingNorthing}};

inline constexpr std::tuple kFormatOfTrajectory{Field{
    .member = &TrajectoryOptions::format,
    .key = "format",
    .option = "--trajectory-format",
    .group = OptionGroup::kPath,
    .value_name = "FORMAT",
    .help = "Format of the trajectory where a guess could go wrong",
    .usual = "auto",
    .doc = "'auto', 'matrix', 'tum', 'euroc', 'csv', 'pose-xyzw', 'pose-wxyz', 'sbet', '3dtk-pose' "
           "or '3dtk-frames'."}};

inline constexpr std::tuple kRigidityOfTrajectory{
    Field{.member = &TrajectoryOptions::allow_non_rigid,
          .key = "allow_non_rigid",
          .option = "--allow-non-rigid",
          .group = OptionGroup::kPath,
          .help = "Accept matrices that scale or shear",
          .doc = "Also takes matrices that scale or shear."}};

/// What the numbers of a trajectory mean. One option of the command line, --angles, sets unit and
/// frame of the angles.
inline constexpr std::tuple kNumbersOfTrajectory{
    Field{.member = &TrajectoryOptions::angle_unit,
          .key = "angle_unit",
          .doc = "The unit of angles: 'deg', 'rad', or 'declared', which is what the file says."},
    Field{.member = &TrajectoryOptions::angle_frame,
          .key = "angle_frame",
          .doc = "How angles count: 'ned' (clockwise from north), 'enu' (counter-clockwise from\n"
                 "    east), or 'declared', which is what the file says."},
    Field{.member = &TrajectoryOptions::crs,
          .key = "crs",
          .option = "--trajectory-crs",
          .group = OptionGroup::kUnits,
          .value_name = "CRS",
          .help = "Projected CRS to turn latitudes and longitudes into, for example EPSG:25832",
          .usual = "that of the environment, where the command has one",
          .doc = "The projected coordinate system to turn latitudes and longitudes into, such as "
                 "'EPSG:25832'."},
    Field{.member = &TrajectoryOptions::datum,
          .key = "datum",
          .option = "--trajectory-datum",
          .group = OptionGroup::kUnits,
          .value_name = "CRS",
          .help = "Geographic CRS of latitudes and longitudes, for example EPSG:4937",
          .usual = "WGS 84",
          .doc = "The geographic coordinate system of latitudes and longitudes; empty: WGS 84."},
    Field{.member = &TrajectoryOptions::metres_per_unit,
          .key = "metres_per_unit",
          .campaign_key = "unit",
          .option = "--trajectory-unit",
          .group = OptionGroup::kUnits,
          .help = "Unit of the positions; ft is the environment's foot, ift the international and "
                  "us-ft the US survey foot",
          .usual = "what a header says, otherwise that of the environment",
          .doc = "The unit of positions: metres, or a name: 'mm', 'cm', 'm', 'in', 'ft' (the\n"
                 "    environment's foot, also METRES_PER_FOOT), 'ift' (the international foot) or "
                 "'us-ft' (the US\n    survey foot); 0: metres, unless the file names a unit."}};

inline constexpr std::tuple kPlaceOfTrajectory{
    Field{.member = &TrajectoryOptions::lever_arm,
          .key = "lever_arm",
          .option = "--lever-arm",
          .group = OptionGroup::kPath,
          .help = "Where the point that the trajectory gives, such as an antenna, lies in the "
                  "model's frame, in metres",
          .doc = "Where the positions of the file lie in the model's frame: x, y and z, metres."}};

/// How a trajectory is read by whom only its poses concern, such as a conversion.
inline constexpr std::tuple kReadingFields =
    std::tuple_cat(kFormatOfTrajectory, kNumbersOfTrajectory);

/// How the trajectory of a vehicle is read.
inline constexpr std::tuple kTrajectoryFields = std::tuple_cat(
    kFormatOfTrajectory, kRigidityOfTrajectory, kNumbersOfTrajectory, kPlaceOfTrajectory,
    std::tuple{Field{.member = &TrajectoryOptions::default_crs,
                     .key = "default_crs",
                     .doc = "The coordinate system to take where crs is empty, for example "
                            "store.crs_wkt()."}});

}  // namespace clearway
