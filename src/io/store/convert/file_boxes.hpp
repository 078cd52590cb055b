#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/progress.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/messages/messages.hpp"
#include "io/store/convert/quanta_batch.hpp"

namespace clearway {

/// The box of each input, with the points that are too far from a path. add() may be called from
/// several threads.
class FileBoxes {
 public:
  void add(const QuantaBatch& batch);
  /// The boxes of `files` inputs.
  std::vector<FileBox> boxes(std::size_t files) const;

  template <typename Values>
  void keep(Values& values) {
    values.add(boxes_);
  }

 private:
  std::vector<FileBox> boxes_;
  std::mutex mutex_;
};

/// The box in metres.
Box box_of(const FileBox& box, const Quantisation& quantisation);

/// The box of all inputs in metres; nullopt where there is no point.
std::optional<Box> common_box(std::span<const FileBox> boxes, const Quantisation& quantisation);

/// Warns of inputs that hold no point, lie far from all others, or are far larger than others; of
/// points far beyond the box that their file declares; and of points at the ends of their integers.
/// infos: of each input.
void warn_of_boxes(std::span<const FileBox> boxes, const Quantisation& quantisation,
                   std::span<const std::filesystem::path> files, std::span<const CloudInfo> infos,
                   MessageLog& log);

}  // namespace clearway
