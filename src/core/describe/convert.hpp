#pragma once

#include <tuple>

#include "clearway/convert.hpp"
#include "core/describe/machine.hpp"
#include "core/describe/trajectory.hpp"

namespace clearway {

/// How scans are converted, but for how the path of a moving scanner is read.
inline constexpr std::tuple kConvertFields{
    Field{.member = &ConvertOptions::scale,
          .key = "scale",
          .option = "--scale",
          .group = OptionGroup::kStore,
          .help = "Step of the stored integers in metres",
          .usual = "that of the input, else the finest power of ten from 1e-6 to 1e-3 that fits",
          .doc = "The step of the stored coordinates, metres; None: that of the input, or what "
                 "fits."},
    Field{.member = &ConvertOptions::cell_points,
          .key = "cell_points",
          .option = "--cell-points",
          .group = OptionGroup::kStore,
          .help = "Points per cell, 64 to 1048576",
          .doc = "How many points a cell has at the most, from 64 to 1048576."},
    Field{.member = &ConvertOptions::regular_size,
          .key = "regular_size",
          .doc = "Metres; cells are cubes of it. None: cells of about the same number of points."},
    kMemory<ConvertOptions>,
    kThreads<ConvertOptions>,
    Field{.member = &ConvertOptions::unit,
          .key = "unit",
          .option = "--unit",
          .group = OptionGroup::kUnits,
          .help = "Unit of the coordinates where the inputs name none: m, ft, ift or us-ft",
          .usual = "not known, and taken for metres",
          .doc = "The unit of the coordinates where the inputs name none: 'm', 'ft', 'ift', "
                 "'us-ft', or metres;\n    0: not known, and taken for metres."},
    Field{.member = &ConvertOptions::unit_z,
          .key = "unit_z",
          .option = "--unit-z",
          .group = OptionGroup::kUnits,
          .help = "Unit of the heights where it differs from that of the other coordinates, to "
                  "which they are then converted: mm, cm, m, in, ft, ift or us-ft",
          .doc = "The unit of the heights of all inputs, which are then converted to the unit of "
                 "the other\n    coordinates: a name such as 'us-ft', or metres; 0: heights are in "
                 "the unit of the others."},
    Field{.member = &ConvertOptions::ignore_crs,
          .key = "ignore_crs",
          .option = "--ignore-crs",
          .group = OptionGroup::kUnits,
          .help = "Take coordinates as they are: in degrees or different units, in a system that "
                  "is not read, or on a map that does not keep lengths",
          .doc = "Takes coordinates as they are: in degrees, in different units, in a system that "
                 "is not\n    read, or on a map that does not keep lengths."},
    Field{.member = &ConvertOptions::columns,
          .key = "columns",
          .option = "--columns",
          .group = OptionGroup::kInputs,
          .value_name = "X,Y,Z",
          .help = "Columns of x, y and z in texts: numbers from 1, or names of the header",
          .doc = "Which columns of texts are x, y and z: numbers from 1, or names of the header."},
    Field{.member = &ConvertOptions::origins,
          .key = "origins",
          .option = "--origins",
          .group = OptionGroup::kInputs,
          .help = "Where the scanners stood: CSV with the header first,x,y,z, from source index "
                  "`first` on",
          .usual = "what the scans say",
          .doc = "A CSV file with the header first,x,y,z: from source index first on, the scanner "
                 "stood at\n    x, y, z. None: the places are those that the inputs name."},
    Field{.member = &ConvertOptions::origins_path,
          .key = "origins_path",
          .option = "--origins-path",
          .group = OptionGroup::kPath,
          .help = "The path of a moving scanner, a trajectory with times: each point of LAS or LAZ "
                  "was seen from where it is at the point's GPS time",
          .doc = "The path of a moving scanner, a trajectory with times: each point of LAS and LAZ "
                 "was\n    seen from where the scanner is at the point's GPS time. It excludes "
                 "origins."},
    Field{.member = &ConvertOptions::lever_arm,
          .key = "lever_arm",
          .option = "--lever-arm",
          .group = OptionGroup::kPath,
          .help = "Where the scanner is in the frame of the poses of --origins-path, in metres",
          .usual = "0,0,0",
          .doc = "Where the scanner is in the frame of the poses of origins_path: x, y and z, "
                 "metres."},
    Field{.member = &ConvertOptions::near,
          .key = "near",
          .option = "--near",
          .group = OptionGroup::kCorridor,
          .help = "A trajectory: keep only the points within --within of its path. Questions that "
                  "reach beyond are refused",
          .doc = "A trajectory: only the points within its path's distance `within` are stored. "
                 "Questions that\n    reach beyond are refused."},
    Field{.member = &ConvertOptions::within,
          .key = "within",
          .option = "--within",
          .group = OptionGroup::kCorridor,
          .help = "The greatest distance of a point from the path of --near, in metres",
          .usual = "none",
          .doc = "The greatest distance of a point from the path of near, metres."},
    Field{.member = &ConvertOptions::trust_bounds,
          .key = "trust_bounds",
          .option = "--trust-bounds",
          .group = OptionGroup::kCorridor,
          .help = "Do not read LAS and LAZ files whose header's bounds lie beyond --within",
          .doc = "Does not read LAS and LAZ files whose header's bounds lie beyond `within`."},
    Field{.member = &ConvertOptions::keep_withheld,
          .key = "keep_withheld",
          .option = "--keep-withheld",
          .group = OptionGroup::kInputs,
          .help = "Keep points of LAS and LAZ with the flag withheld, which are left out otherwise",
          .doc = "Keeps points of LAS and LAZ with the flag withheld, which are left out "
                 "otherwise."},
    Field{.member = &ConvertOptions::skip_unreadable,
          .key = "skip_unreadable",
          .option = "--skip-unreadable",
          .group = OptionGroup::kInputs,
          .help = "Leave out files that cannot be read, and list them; reads all once more",
          .doc = "Leaves out files that cannot be read, with a warning."},
    Field{.member = &ConvertOptions::strict,
          .key = "strict",
          .option = "--strict",
          .group = OptionGroup::kOutput,
          .help = "Treat warnings as errors: all are shown, and no store is written (exit code 3)",
          .doc = "Treats warnings as errors: raises InputError."},
    Field{.member = &ConvertOptions::overwrite,
          .key = "overwrite",
          .option = "--force",
          .group = OptionGroup::kFiles,
          .help = "Overwrite an existing store",
          .doc = "Replaces an existing store."},
    Field{.member = &ConvertOptions::resume,
          .key = "resume",
          .option = "--resume",
          .group = OptionGroup::kFiles,
          .help = "Go on with a conversion of the same inputs that was interrupted or killed, and "
                  "leave their finished store as it is",
          .doc = "Goes on with a conversion of the same inputs and options that was interrupted, "
                 "and leaves\n    their finished store as it is; any other file there is "
                 "refused."}};

}  // namespace clearway
