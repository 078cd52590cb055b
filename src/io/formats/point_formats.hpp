#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace clearway {

enum class PointFormat { kLas, kPly, kXyz, kE57, kPcd, kPtx, k3dtk, kMesh };

/// The format that a file's first bytes tell; none where they do not.
std::optional<PointFormat> format_of_content(std::span<const std::byte> first_bytes);

/// The format that the ending of a name tells; none where it does not.
std::optional<PointFormat> format_of_name(const std::filesystem::path& path);

/// Whether a file of a folder counts as a point file: its ending is that of a format of points, and
/// of nothing else (.txt and .csv may hold anything, so such files have to be named themselves).
bool is_surely_point_file(const std::filesystem::path& path);

/// The endings of such files, for a message: "las, ply, ... or pcd".
std::string sure_endings();

/// Throws InputError that names the format and says what to do, where it is not read.
void refuse_unless_read(PointFormat format, const std::string& name);

}  // namespace clearway
