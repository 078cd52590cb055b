#pragma once

#include <string>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/trajectory.hpp"
#include "support/compare.hpp"

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

}  // namespace clearway::test
