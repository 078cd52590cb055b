#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/convert.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/scans/point_reader.hpp"

/// The unit and reference system on which the inputs of a conversion agree
/// (docs/design/conversion.md). All functions here take the files and their declarations in the
/// order of the inputs, and throw InputError that names the file that differs.
namespace clearway {

struct CommonCrs {
  LengthUnit unit = LengthUnit::kUnknown;
  std::string wkt;
  /// The system of the first input that names one, in a form that scan_crs_of() reads; empty where
  /// none does.
  std::string crs;
  double height_unit = 0;    ///< metres per unit of the heights as read, where it was given
  double height_factor = 1;  ///< brings heights as read to `unit`
  /// Whether an input says something of its unit or system that is not read.
  bool is_partly_read = false;
  /// Warnings on CRS and units; notes where some inputs have no CRS and where heights are
  /// converted.
  std::vector<Message> warnings;
};

/// The unit and CRS of the first input that names them. Degrees, units and heights other than that
/// one's, and systems that are not read, are refused unless they are to be ignored, which is a
/// warning. Inputs that name no unit are given ConvertOptions::unit, or count as metres.
CommonCrs common_crs(std::span<const std::filesystem::path> files, std::span<const CloudInfo> infos,
                     const ConvertOptions& given);

/// The unit and CRS on which scans agree by what their files declare before the first point.
/// inputs: files and folders. Throws as a conversion with these options does.
CommonCrs declared_crs(const std::vector<std::filesystem::path>& inputs,
                       const ConvertOptions& options);

/// Whether a conversion gave this warning because it was to ignore what it would refuse.
bool is_of_ignored_crs(const Message& warning);

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
