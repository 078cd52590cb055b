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
#include "io/formats/point_reader.hpp"

/// What the inputs of a conversion agree on (docs/design/conversion.md). Everywhere files and what
/// they say of themselves, in the order of the inputs. Throws InputError naming the file that
/// differs.
namespace clearway {

struct CommonCrs {
  LengthUnit unit = LengthUnit::kUnknown;
  std::string wkt;
  std::vector<Message> warnings;  ///< different CRS, feet; a note: none in some
};

/// Of the first input that says so. Degrees, and other units than that one's, are refused unless
/// `ignore`. Inputs that say nothing go with metres.
CommonCrs common_crs(std::span<const std::filesystem::path> files, std::span<const CloudInfo> infos,
                     const FileUnit& unit, bool ignore);

struct CommonQuanta {
  Quantisation quantisation{};                      ///< that of the first input with integers
  std::vector<std::array<std::int64_t, 3>> shifts;  ///< per input with integers: quanta to add
};

/// How the inputs' integers can be kept: all of one scale, the one asked for if any, and their
/// offsets apart by whole quanta. Inputs of floating-point numbers are then rounded to the same
/// quanta. None where all are to be rounded anew.
std::optional<CommonQuanta> common_quanta(std::span<const std::filesystem::path> files,
                                          std::span<const CloudInfo> infos,
                                          std::optional<double> scale);

/// On the inputs of floating-point numbers beside others of integers; none where all are alike.
std::optional<Message> remark_on_mixture(std::span<const std::filesystem::path> files,
                                         std::span<const CloudInfo> infos,
                                         const Quantisation& quantisation);

}  // namespace clearway
