#include "campaign/input_stamp.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "clearway/error.hpp"
#include "io/vehicle/vehicle_file.hpp"

namespace clearway::campaign {
namespace {

namespace fs = std::filesystem;

std::optional<InputStamp> stamp_of(const std::string& what, const fs::path& file) {
  std::error_code failed;
  const fs::file_time_type modified = fs::last_write_time(file, failed);
  if (failed) return std::nullopt;
  const std::uintmax_t bytes = fs::is_directory(file, failed) ? 0 : fs::file_size(file, failed);
  if (failed) return std::nullopt;
  using Nanoseconds = std::chrono::nanoseconds;
  return InputStamp{what, file.string(), bytes,
                    std::chrono::duration_cast<Nanoseconds>(modified.time_since_epoch()).count()};
}

/// The files that a vehicle's file names; none where it cannot be read, which the run will report.
std::vector<std::pair<std::string, fs::path>> files_of_bodies(const fs::path& vehicle) {
  std::vector<std::pair<std::string, fs::path>> files;
  try {
    for (const BodyEntry& body : read_vehicle_file(vehicle, 1)) {
      files.emplace_back("model", body.model);
      if (!body.trajectory.empty()) files.emplace_back("trajectory", body.trajectory);
    }
  } catch (const Error&) {
    files.clear();
  }
  return files;
}

/// The words of the task's `clearway run`, which is the second command of a merge and the first of
/// any other task; null where there is none.
const Command* run_of_commands(const Task& task) {
  const auto run = std::ranges::find_if(
      task.commands, [](const Command& words) { return !words.empty() && words[0] == "run"; });
  return run == task.commands.end() ? nullptr : &*run;
}

}  // namespace

std::vector<InputStamp> stamps_of(const Task& task) {
  constexpr std::array<std::pair<std::string_view, const char*>, 4> kOptions{
      {{"--env=", "environment"},
       {"--model=", "model"},
       {"--vehicle=", "vehicle"},
       {"--trajectory=", "trajectory"}}};
  std::vector<std::pair<std::string, fs::path>> files;
  if (const Command* run = run_of_commands(task)) {
    for (const std::string& word : *run) {
      for (const auto& [option, what] : kOptions) {
        if (word.starts_with(option)) files.emplace_back(what, word.substr(option.size()));
      }
    }
  }
  std::vector<InputStamp> stamps;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i].first == "vehicle") {
      for (auto& file : files_of_bodies(files[i].second)) files.push_back(std::move(file));
    }
    auto stamp = stamp_of(files[i].first, files[i].second);
    if (stamp && std::ranges::find(stamps, *stamp) == stamps.end()) stamps.push_back(*stamp);
  }
  return stamps;
}

std::string changed_since(const std::vector<InputStamp>& stamps) {
  std::string text;
  for (const InputStamp& stamp : stamps) {
    const auto now = stamp_of(stamp.what, stamp.file);
    if (!now || *now == stamp) continue;
    text += (text.empty() ? "the " : ", the ") + stamp.what + " file " +
            fs::path(stamp.file).filename().string() + " changed";
  }
  return text.empty() ? "" : text + " since this run";
}

}  // namespace clearway::campaign
