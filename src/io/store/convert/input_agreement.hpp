#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/progress.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/scans/point_reader.hpp"

/// The unit and reference system on which the inputs of a conversion agree
/// (docs/design/conversion.md). All functions here take the files and their declarations in the
/// order of the inputs, and throw InputError that names the file that differs.
namespace clearway {

struct CommonCrs {
  LengthUnit unit = LengthUnit::kUnknown;
  std::string wkt;
  /// Warnings on different CRS and on feet; a note where some inputs have no CRS.
  std::vector<Message> warnings;
};

/// The unit and CRS of the first input that names them. Degrees, and units other than that one's,
/// are refused unless `ignore`. Inputs that name no unit count as metres.
CommonCrs common_crs(std::span<const std::filesystem::path> files, std::span<const CloudInfo> infos,
                     const FileUnit& unit, bool ignore);

struct CommonQuanta {
  Quantisation quantisation{};  ///< quantisation of the first input with integers
  std::vector<std::array<std::int64_t, 3>> shifts;  ///< per input, quanta to add to its integers
};

/// The common quantisation in which the inputs' integers can be kept: all have one scale, the
/// requested one if any, and their offsets differ by whole quanta. Inputs of floating-point numbers
/// are then rounded to the same quanta. Nullopt where all inputs must be rounded anew.
std::optional<CommonQuanta> common_quanta(std::span<const std::filesystem::path> files,
                                          std::span<const CloudInfo> infos,
                                          std::optional<double> scale);

/// The remark that some inputs have floating-point coordinates and others integers; nullopt where
/// all are alike.
std::optional<Message> remark_on_mixture(std::span<const std::filesystem::path> files,
                                         std::span<const CloudInfo> infos,
                                         const Quantisation& quantisation);

}  // namespace clearway
