#include <algorithm>
#include <functional>
#include <map>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/point_formats.hpp"
#include "io/scans/point_reader.hpp"
#include "io/scans/threedtk/threedtk_reader.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostNames = 5;  // at most this many file names in a message

/// The files directly in a folder, in byte order of their names, without hidden ones.
struct Folder {
  std::vector<fs::path> scans, others, folders;
};

bool in_byte_order(const fs::path& a, const fs::path& b) {
  // std::string compares its bytes as unsigned, so this is byte order.
  return a.filename().native() < b.filename().native();
}

Folder look_into(const fs::path& path) {
  Folder found;
  std::error_code error;
  const fs::directory_iterator end;
  for (fs::directory_iterator at(path, error); !error && at != end; at.increment(error)) {
    std::error_code unknown;
    if (at->path().filename().native().starts_with('.')) continue;
    if (at->is_directory(unknown)) {
      found.folders.push_back(at->path());
    } else {
      (is_surely_point_file(at->path()) ? found.scans : found.others).push_back(at->path());
    }
  }
  if (error) throw ResourceError(path.string() + ": cannot list the folder: " + error.message());
  std::sort(found.scans.begin(), found.scans.end(), in_byte_order);
  std::sort(found.others.begin(), found.others.end(), in_byte_order);
  std::sort(found.folders.begin(), found.folders.end(), in_byte_order);
  return found;
}

/// Whether a folder, or a folder in it, holds a point file. Of very large trees only the beginning
/// is looked at.
bool holds_point_files(const fs::path& folder) {
  constexpr int kMostEntries = 10'000, kMostDepth = 4;
  std::error_code error;
  int looked_at = 0;
  fs::recursive_directory_iterator at(folder, error);
  for (; !error && at != fs::recursive_directory_iterator() && looked_at < kMostEntries;
       at.increment(error), ++looked_at) {
    if (at.depth() >= kMostDepth) at.disable_recursion_pending();
    std::error_code unknown;
    if (at->is_regular_file(unknown) && is_surely_point_file(at->path())) return true;
  }
  return false;
}

/// Whether a file whose ending does not say so can be read as points: a text file of coordinates,
/// or a scan with another name.
bool looks_like_points(const fs::path& file) {
  std::error_code unknown;
  if (!fs::is_regular_file(file, unknown)) return false;
  try {
    PointBatch batch;
    return open_point_file(file)->read(batch) && batch.size() > 0;
  } catch (const Error&) {
    return false;
  }
}

/// The names in a message, as in "a.txt, b.csv and 7 more".
std::string names_of(const std::vector<fs::path>& files, std::size_t most = kMostNames) {
  std::string text;
  for (std::size_t i = 0; i < std::min(files.size(), most); ++i) {
    text += (i > 0 ? ", " : "") + files[i].filename().string();
  }
  if (files.size() <= most) return text;
  return text + " and " + std::to_string(files.size() - most) + " more";
}

bool is_pose_file(const fs::path& file) {
  return file.extension() == ".pose" || file.extension() == ".frames";
}

/// Separates the files of poses that lie beside scans. Those of 3DTK's scans are read together with
/// the scans; those of other scans would place them elsewhere. Returns the latter. Both kinds are
/// removed from `others`.
std::vector<fs::path> take_poses(Folder& folder) {
  // By name without ending: whether the scan is read with its pose.
  std::map<std::string, bool> placed;
  for (const fs::path& scan : folder.scans) {
    placed[scan.stem().native()] |= format_of_name(scan) == PointFormat::k3dtk;
  }
  std::vector<fs::path> unused;
  std::erase_if(folder.others, [&](const fs::path& file) {
    if (!is_pose_file(file)) return false;
    const auto scan = placed.find(file.stem().native());
    if (scan == placed.end()) return false;
    if (!scan->second) unused.push_back(file);
    return true;
  });
  return unused;
}

/// Warns of folders and files that are left out although they have points, and removes them from
/// `folder`.
void warn_of_left_out(const fs::path& path, Folder& folder, std::vector<Message>& remarks) {
  constexpr std::size_t kMost = 3;
  const auto take = [](std::vector<fs::path>& from, auto has_points) {
    const auto kept = std::stable_partition(from.begin(), from.end(), std::not_fn(has_points));
    const std::vector<fs::path> taken(kept, from.end());
    from.erase(kept, from.end());
    return taken;
  };
  const std::vector<fs::path> folders = take(folder.folders, holds_point_files);
  const std::vector<fs::path> files = take(folder.others, looks_like_points);
  if (folders.empty() && files.empty()) return;
  std::vector<std::string> what;
  if (!folders.empty()) {
    what.push_back(fmt::format("{} that {} point files ({})", counted(folders.size(), "folder"),
                               folders.size() == 1 ? "holds" : "hold", names_of(folders, kMost)));
  }
  if (!files.empty()) {
    what.push_back(fmt::format("{} that {} like points ({})", counted(files.size(), "file"),
                               files.size() == 1 ? "looks" : "look", names_of(files, kMost)));
  }
  remarks.push_back(warning(
      "left-out", {{"files", files.size()}, {"folders", folders.size()}},
      "{}: left out {}. The environment lacks them; if they belong to it, name them as inputs too",
      path.string(), format_list(what)));
}

void remark_on(const fs::path& path, Folder folder, std::vector<Message>& remarks) {
  const std::vector<fs::path> poses = take_poses(folder);
  if (!poses.empty()) {
    remarks.push_back(warning("poses-not-applied", {{"files", poses.size()}},
                              "{}: {} with the pose of a scan ({}). Poses are applied to files "
                              "with the ending 3d only, these scans stay as they are",
                              path.string(), counted(poses.size(), "file"), names_of(poses)));
  }
  warn_of_left_out(path, folder, remarks);
  if (folder.others.empty() && folder.folders.empty()) return;
  std::vector<std::string> what;
  for (const auto& [names, noun] :
       {std::pair(&folder.others, "file"), {&folder.folders, "folder"}}) {
    if (names->empty()) continue;
    what.push_back(fmt::format("{} ({})", counted(names->size(), noun), names_of(*names)));
  }
  remarks.push_back(note("left-out",
                         {{"files", folder.others.size()}, {"folders", folder.folders.size()}},
                         "{}: left out {}", path.string(), format_list(what)));
}

std::vector<fs::path> files_of_folder(const fs::path& path, std::vector<Message>* remarks) {
  Folder folder = look_into(path);
  if (folder.scans.empty()) {
    refuse(path.string(), "holds no point file; expected files with the ending " + sure_endings() +
                              " (txt and csv files have to be named themselves)");
  }
  std::vector<fs::path> scans = folder.scans;
  if (remarks) remark_on(path, std::move(folder), *remarks);
  return scans;
}

}  // namespace

std::vector<fs::path> list_point_files(const std::vector<fs::path>& inputs,
                                       std::vector<Message>* remarks) {
  std::vector<fs::path> files;
  for (const fs::path& input : inputs) {
    std::error_code error;
    const fs::file_status status = fs::status(input, error);
    if (!fs::exists(status)) {
      throw ResourceError(input.string() + ": no such file or folder");
    }
    if (fs::is_directory(status)) {
      const auto found = files_of_folder(input, remarks);
      files.insert(files.end(), found.begin(), found.end());
    } else {
      files.push_back(input);
    }
  }
  return files;
}

std::vector<fs::path> with_pose_files(std::vector<fs::path> files) {
  std::vector<fs::path> poses;
  for (const fs::path& file : files) {
    if (format_of_name(file) != PointFormat::k3dtk) continue;
    if (auto pose = threedtk_pose_file(file)) poses.push_back(std::move(*pose));
  }
  files.insert(files.end(), poses.begin(), poses.end());
  return files;
}

std::vector<fs::path> files_behind(const fs::path& input) {
  std::error_code unknown;
  if (!fs::is_directory(input, unknown)) return with_pose_files({input});
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(input, unknown)) {
    if (is_pose_file(entry.path())) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace clearway
