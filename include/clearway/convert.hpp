#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/file_unit.hpp"
#include "clearway/progress.hpp"

namespace clearway {

/// Every member has a value, so that {.memory_bytes = ...} compiles without a warning.
struct ConvertOptions {
  /// Metres, of the stored integers; none: as the input has it, else the finest power of ten from
  /// 1e-6 to 1e-3 that fits.
  std::optional<double> scale = std::nullopt;
  std::uint32_t cell_points = 65536;  ///< 64 to 2^20
  std::optional<double> regular_size =
      std::nullopt;  ///< metres: cells are cubes of it; none: adaptive
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  int threads = 0;  ///< 0: all cores
  /// The unit of the coordinates of inputs that name none: the metre, or a foot. Inputs that name a
  /// unit must name this one. None: the unit stays unknown and is taken for the metre.
  FileUnit unit = {};
  bool ignore_crs = false;  ///< coordinates in degrees, or in different units, as they are
  /// Of x, y and z in texts: numbers counted from 1, or names of the header. Empty: as they say.
  std::vector<std::string> columns = {};
  bool skip_unreadable = false;  ///< leaves out files that cannot be read, with a warning
  bool strict = false;           ///< refuses every warning, once all are told, and writes no store
  bool overwrite = false;        ///< an existing store
  bool resume = false;           ///< leaves a store of the same inputs as it is
  ProgressCallback progress = nullptr;
  MessageCallback message = nullptr;  ///< notes, and the warnings that the report holds
  StopFlag stop = nullptr;
};

/// How long all threads together were busy with a stage of a conversion.
struct StageSeconds {
  std::string stage;
  double seconds = 0;
};

struct ConvertReport {
  bool was_finished = false;  ///< the store was there already: nothing was converted
  std::uint64_t points = 0;   ///< stored
  std::uint64_t cells = 0;
  std::uint64_t non_finite_points = 0;    ///< left out
  std::uint64_t absent_points = 0;        ///< records without a point: beams without a return
  Vec3 scale{}, offset{};                 ///< of the stored integers, metres
  std::optional<Box> box = std::nullopt;  ///< of the stored points; none where there is none
  double largest_change = 0;              ///< of any coordinate by rounding to the scale, metres
  std::uint64_t temporary_bytes = 0;
  std::uint64_t output_bytes = 0;
  /// Wall clock; count_seconds holds all before too.
  double count_seconds = 0, distribute_seconds = 0, partition_seconds = 0, confirm_seconds = 0;
  std::vector<StageSeconds> busy_seconds = {};
  std::vector<Message> warnings = {};
};

/// Turns scans into a store: LAS, LAZ, E57, PLY, PCD, PTX, PTS, 3DTK and text; files and folders,
/// or "-" alone for LAS or LAZ on standard input. Throws UsageError, InputError, ResourceError;
/// Interrupted when asked to stop. Whatever happens, nothing stands under the output's name that is
/// not complete.
ConvertReport convert(const std::vector<std::filesystem::path>& inputs,
                      const std::filesystem::path& output, const ConvertOptions& options = {});

}  // namespace clearway
