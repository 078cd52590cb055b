#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "io/scans/input_buffer.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// The file beside a scan that holds its pose: scanNNN.frames, otherwise scanNNN.pose; nullopt
/// where there is neither.
std::optional<std::filesystem::path> threedtk_pose_file(const std::filesystem::path& scan);

/// Reads a scan of 3DTK, scanNNN.3d: text with x y z and anything after. Its points come in
/// right-handed metres (threedtk_frame.hpp), placed by the last line of scanNNN.frames, otherwise
/// by scanNNN.pose. A scan without either is refused unless it is alone in its folder. The input
/// must be able to seek. Throws InputError.
std::unique_ptr<PointReader> read_threedtk(InputBuffer input, const std::filesystem::path& path);

}  // namespace clearway
