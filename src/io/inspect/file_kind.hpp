#pragma once

#include <filesystem>
#include <string>

namespace clearway {

/// What a file is, whatever it was given as.
enum class FileKind {
  kUnknown,  ///< also what is no regular file, or cannot be read
  kEmpty,
  kStore,
  kResult,
  kOtherHdf5,
  kJournal,
  kPoints,      ///< a scan or a model, in a format that its first bytes tell
  kMesh,        ///< by the ending of its name
  kTrajectory,  ///< a text of poses
  kTextPoints,  ///< a text of numbers that are no poses
};

struct FileDescription {
  FileKind kind = FileKind::kUnknown;
  std::string words;  ///< for messages, after "is": "a scan (LAS)", "a result"
};

/// Looks at the first bytes, of a text at its first lines, and at the ending of its name. It says
/// what the file was meant to be, not whether it is sound. Throws ResourceError where there is no
/// file of that name.
FileDescription describe_file(const std::filesystem::path& path);

/// "LAS", "LAZ", "PLY", "E57": a file of points by its content, otherwise by its name; "text" for
/// all texts.
std::string point_format_name(const std::filesystem::path& path);

}  // namespace clearway
