#pragma once

#include <filesystem>
#include <string>

namespace clearway {

/// What a file is, whatever it was passed as.
enum class FileKind {
  kUnknown,  ///< also anything that is not a regular file or cannot be read
  kEmpty,
  kStore,
  kResult,
  kSection,
  kOtherHdf5,
  kJournal,
  kPoints,      ///< a scan or a model, in a format recognised by its first bytes
  kMesh,        ///< a mesh, by the ending of its name
  kTrajectory,  ///< a text file of poses
  kTextPoints,  ///< a text file of numbers that are not poses
};

struct FileDescription {
  FileKind kind = FileKind::kUnknown;
  std::string words;  ///< for messages, after "is": "a scan (LAS)", "a result"
};

/// Describes a file by its first bytes, or for text its first lines, and by the ending of its
/// name. This says what the file was meant to be, not whether it is intact. Throws ResourceError
/// where there is no file of that name.
FileDescription describe_file(const std::filesystem::path& path);

/// The name of a point file's format, such as "LAS", "LAZ", "PLY" or "E57", by content or otherwise
/// by the file's name; "text" for all text files.
std::string point_format_name(const std::filesystem::path& path);

}  // namespace clearway
