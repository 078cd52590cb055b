#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/trajectory.hpp"
#include "support/compare.hpp"
#include "support/scratch_folder.hpp"
#include "support/text_rows.hpp"

namespace clearway::test {

/// What a reader makes of a file with a path.
struct MadePath {
  std::vector<Pose> poses;
  std::vector<Message> remarks;
  PoseLabels labels;

  std::string codes() const { return codes_of(remarks); }
  std::string text() const {
    std::string all;
    for (const Message& remark : remarks) all += remark.text + "\n";
    return all;
  }
};

/// Reads a trajectory from a file of this name and text.
inline MadePath read_path(const std::string& text, const TrajectoryOptions& options = {},
                          const std::string& name = "path.txt") {
  const ScratchFolder scratch;
  MadePath made;
  made.poses = read_trajectory(scratch.write(name, text), options, &made.remarks, &made.labels);
  return made;
}

/// Checks that the text is refused with the file's name, then these words, and this remedy.
inline void check_path_refused(const std::string& text, const std::string& words,
                               const TrajectoryOptions& options = {},
                               const std::string& name = "path.txt",
                               std::optional<Remedy> remedy = {}) {
  const RowName row(text.substr(0, 200));
  try {
    read_path(text, options, name);
    fail_check("nothing was refused");
  } catch (const InputError& error) {
    check_says(error.what(), name + " ... " + words);
    if (remedy) CHECK(error.remedy() == *remedy);
  }
}

/// Rows of a text and words of the refusal.
inline void check_paths_refused(std::string_view table, const TrajectoryOptions& options = {},
                                std::optional<Remedy> remedy = {}) {
  for (const auto& row : text_rows(table)) {
    check_path_refused(row[0], row[1], options, "path.txt", remedy);
  }
}

}  // namespace clearway::test
