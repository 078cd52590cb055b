#include "cli/input_roles.hpp"

#include <string>

#include "clearway/error.hpp"
#include "io/files/input_error.hpp"
#include "io/models/model_input.hpp"
#include "io/store/file_kind.hpp"

namespace clearway::tool {
namespace {

/// Advice on a file in the wrong place: the option that takes it, or how to make what is needed.
std::string use_of(FileKind kind, const std::filesystem::path& path) {
  switch (kind) {
    case FileKind::kStore:
      return "; --env takes it";
    case FileKind::kResult:
      return "; clearway info and clearway export read it";
    case FileKind::kSection:
      return "; clearway section check and clearway section export read it";
    case FileKind::kJournal:
      return "; the run or conversion that it belongs to goes on with --resume";
    case FileKind::kTrajectory:
      return "; --trajectory takes it";
    case FileKind::kPoints:
    case FileKind::kTextPoints:
      return ": convert it first: clearway convert " + path.filename().string() + " -o " +
             path.stem().string() + ".h5";
    case FileKind::kMesh:
      return "; a mesh can be the model";
    default:
      return "";
  }
}

[[noreturn]] void refuse_role(const std::filesystem::path& path, const FileDescription& file,
                              const char* expected, const std::string& advice) {
  refuse(path.string(), "is " + file.words + ", not " + expected + advice);
}

bool is_one_of_ours(FileKind kind) {
  return kind == FileKind::kStore || kind == FileKind::kResult || kind == FileKind::kSection ||
         kind == FileKind::kJournal;
}

}  // namespace

void check_is_store(const std::filesystem::path& path) {
  const FileDescription file = describe_file(path);
  // The store's reader explains what is wrong with a damaged store.
  if (file.kind == FileKind::kStore || file.kind == FileKind::kOtherHdf5 ||
      file.kind == FileKind::kUnknown) {
    return;
  }
  refuse_role(path, file, "a store", use_of(file.kind, path));
}

void check_is_model(const std::filesystem::path& path) {
  if (names_box(path)) return;
  const FileDescription file = describe_file(path);
  if (!is_one_of_ours(file.kind) && file.kind != FileKind::kTrajectory) return;
  refuse_role(path, file, "a model (points of the vehicle in its own frame)",
              use_of(file.kind, path));
}

void check_has_poses(const std::vector<Pose>& poses, const std::filesystem::path& path) {
  if (!poses.empty()) return;
  throw InputError(path.string() +
                   ": has no poses; expected at least one, because a vehicle that is nowhere "
                   "comes close to nothing");
}

void check_is_trajectory(const std::filesystem::path& path) {
  const FileDescription file = describe_file(path);
  const bool points = file.kind == FileKind::kPoints || file.kind == FileKind::kMesh;
  if (!is_one_of_ours(file.kind) && !points) return;
  refuse_role(path, file, "a trajectory (a list of poses)",
              points ? "; --model takes it, or clearway convert" : use_of(file.kind, path));
}

}  // namespace clearway::tool
