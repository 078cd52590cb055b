#include "io/paths/threedtk_trajectory.hpp"

#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "io/scans/formatted_message.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/threedtk/threedtk_frame.hpp"

namespace clearway {
namespace {

/// The number NNN of a file "scanNNN" with this ending; nullopt for other names.
std::optional<std::uint64_t> number_of(const std::filesystem::path& path, std::string_view ending) {
  constexpr std::string_view kScan = "scan";
  const std::string text = path.stem().string();
  if (path.extension() != ending || !text.starts_with(kScan)) return std::nullopt;
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + kScan.size(), end, number);
  if (error != std::errc() || stop != end) return std::nullopt;
  return number;
}

using Files = std::map<std::uint64_t, std::filesystem::path>;

Files files_of(const std::filesystem::path& folder, std::string_view ending) {
  Files files;
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
    const auto number = number_of(entry.path(), ending);
    if (!number) continue;
    const auto [at, added] = files.emplace(*number, entry.path());
    if (!added) {
      refuse(folder.string(), at->second.filename().string() + " and " +
                                  entry.path().filename().string() + " have the same number");
    }
  }
  if (failed) throw ResourceError(folder.string() + ": " + failed.message());
  return files;
}

void note_frame(const std::string& name, TrajectoryFile& out) {
  out.note("model-frame",
           name +
               ": 3DTK's frame, left-handed in centimetres, was turned into metres with x "
               "forward, y left and z up, as scans of 3DTK are; the model is to have that "
               "frame too");
}

void read_one(const std::filesystem::path& path, TrajectoryFormat format, TrajectoryFile& out) {
  TextTable table(InputBuffer::open(path));
  out.poses.push_back(format == TrajectoryFormat::kThreedtkFrames ? read_threedtk_frames(table)
                                                                  : read_threedtk_pose(table));
  out.labels.name.push_back(path.filename().string());
}

}  // namespace

void read_threedtk_file(const std::filesystem::path& path, const TrajectoryOptions& options,
                        TrajectoryFile& out) {
  out.format = options.format;
  out.in_metres = true;
  read_one(path, out.format, out);
  note_frame(path.string(), out);
}

void read_threedtk_folder(const std::filesystem::path& folder, const TrajectoryOptions& options,
                          TrajectoryFile& out) {
  const Files poses = files_of(folder, ".pose");
  const Files frames = files_of(folder, ".frames");
  out.in_metres = true;
  out.format = options.format != TrajectoryFormat::kAuto ? options.format
               : frames.empty()                          ? TrajectoryFormat::kThreedtkPose
                                                         : TrajectoryFormat::kThreedtkFrames;
  const Files& files = out.format == TrajectoryFormat::kThreedtkFrames ? frames : poses;
  if (files.empty()) {
    refuse(folder.string(),
           "a folder without scan000.pose or scan000.frames; expected a file, or "
           "a folder of 3DTK");
  }
  for (const auto& [number, path] : poses) {
    if (files.count(number) == 0) {
      refuse(folder.string(), Remedy::kNameFormat,
             "{} has no .frames beside it, other scans have one; name the format to choose",
             path.filename().string());
    }
  }
  for (const auto& [number, path] : files) read_one(path, out.format, out);
  note_frame(folder.string(), out);
  if (out.format == TrajectoryFormat::kThreedtkFrames && !poses.empty()) {
    out.note("frames-not-poses",
             folder.string() + ": the .frames count, where the scans came to lie, not the .pose");
  }
}

}  // namespace clearway
