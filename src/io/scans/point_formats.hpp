#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace clearway {

/// kMesh: a mesh that can be read as a model. kUnreadMesh: one that is not read at all, such as
/// glTF.
enum class PointFormat { kLas, kPly, kXyz, kE57, kPcd, kPtx, k3dtk, kMesh, kUnreadMesh };

/// The format as recognised by a file's first bytes; nullopt where they do not decide.
std::optional<PointFormat> format_of_content(std::span<const std::byte> first_bytes);

/// The format as recognised by the ending of a name; nullopt where it does not decide.
std::optional<PointFormat> format_of_name(const std::filesystem::path& path);

/// Whether a file of a folder counts as a point file: its ending belongs to a format of points and
/// to nothing else. (.txt and .csv may hold anything, so such files must be named themselves.)
bool is_surely_point_file(const std::filesystem::path& path);

/// The endings that belong to formats of points alone, for a message: "las, ply, ... or pcd".
std::string sure_endings();

/// Throws InputError where files of this format are not read. The message names the format and says
/// what to do instead.
void refuse_unless_read(PointFormat format, const std::string& name);

}  // namespace clearway
