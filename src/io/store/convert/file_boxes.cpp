#include "io/store/convert/file_boxes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/util/format.hpp"
#include "io/scans/declared_box.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway {
namespace {

constexpr double kFarSizes = 100;    // gap that counts as far, in sizes of the larger of two boxes
constexpr double kFarLength = 1000;  // least gap that counts as far, in metres
constexpr double kSizeRatio = 300;   // ratio between consecutive sizes in ascending order
// Metres; a smaller input is not suspected to be in another unit.
constexpr double kLargeLength = 3000;
constexpr double kLeastLength = 0.1;         // metres; a smaller input has no size to compare
constexpr std::size_t kMostCompared = 5000;  // number of files that are compared in pairs
constexpr std::size_t kNamed = 3;

std::string text_of(const Box& box) {
  const auto corner = [](const Vec3& p) {
    return "(" + format_number(std::round(p.x)) + ", " + format_number(std::round(p.y)) + ", " +
           format_number(std::round(p.z)) + ")";
  };
  return corner(box.lo) + " to " + corner(box.hi);
}

/// The inputs that have points.
class Inputs {
 public:
  Inputs(std::span<const FileBox> boxes, const Quantisation& quantisation,
         std::span<const std::filesystem::path> files)
      : files_(files) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (boxes[i].points == 0) continue;
      numbers_.push_back(i);
      boxes_.push_back(box_of(boxes[i], quantisation));
      sizes_.push_back(length(boxes_.back().size()));
    }
  }

  /// Warns where inputs form groups that are far from each other. Two are apart where their
  /// gap is many times the size of the larger one. It names an input of the smallest group, and the
  /// nearest of the others.
  void warn_of_distance(MessageLog& log) const {
    const std::vector<std::size_t> group = groups();
    const std::size_t n = group.size();
    std::vector<std::size_t> members(n);
    for (const std::size_t g : group) ++members[g];
    if (n == 0 || members[group[0]] == n) return;
    std::size_t lone = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (members[group[i]] <= members[group[lone]]) lone = i;
    }
    std::optional<std::size_t> other;
    double gap = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double to_i = boxes_[lone].distance(boxes_[i]);
      if (group[i] == group[lone] || (other && to_i >= gap)) continue;
      other = i;
      gap = to_i;
    }
    log.warn("far-apart",
             name(lone) + " lies " + format_brief(gap) + " m from " + name(*other) +
                 ", the nearest of the others: one may be in another frame or unit. Boxes: " +
                 text_of(boxes_[lone]) + "; " + text_of(boxes_[*other]),
             {{"gap", gap}, {"files", members[group[lone]]}});
  }

  /// Warns where consecutive sizes differ by a large factor.
  void warn_of_size(MessageLog& log) const {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < sizes_.size(); ++i) {
      if (sizes_[i] >= kLeastLength) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(),
                     [this](std::size_t a, std::size_t b) { return sizes_[a] < sizes_[b]; });
    for (std::size_t i = 1; i < order.size(); ++i) {
      const double small = sizes_[order[i - 1]], large = sizes_[order[i]];
      if (large < kLargeLength || large < kSizeRatio * small) continue;
      log.add(warning("other-size", {{"ratio", large / small}, {"files", order.size() - i}},
                      "{} is {} times as large as {}: one may be in another unit, such as "
                      "millimetres. Boxes: {}; {}",
                      name(order[i]), format_brief(large / small), name(order[i - 1]),
                      text_of(boxes_[order[i]]), text_of(boxes_[order[i - 1]])));
      return;
    }
  }

 private:
  std::string name(std::size_t i) const { return files_[numbers_[i]].string(); }

  /// The group of each of the first kMostCompared inputs, named by the number of one of its
  /// members.
  std::vector<std::size_t> groups() const {
    std::vector<std::size_t> group(std::min(boxes_.size(), kMostCompared));
    std::iota(group.begin(), group.end(), 0);
    const auto root = [&group](std::size_t i) {
      while (group[i] != i) i = group[i] = group[group[i]];
      return i;
    };
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double near = std::max(kFarLength, kFarSizes * std::max(sizes_[i], sizes_[j]));
        if (boxes_[i].distance(boxes_[j]) <= near) group[root(i)] = root(j);
      }
    }
    for (std::size_t i = 0; i < group.size(); ++i) group[i] = root(i);
    return group;
  }

  std::span<const std::filesystem::path> files_;
  std::vector<std::size_t> numbers_;
  std::vector<Box> boxes_;
  std::vector<double> sizes_;
};

void warn_of_empty(std::span<const FileBox> boxes, std::span<const std::filesystem::path> files,
                   MessageLog& log) {
  std::size_t count = 0;
  std::string names;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].points > 0) continue;
    if (count++ < kNamed) names += (names.empty() ? "" : ", ") + files[i].string();
  }
  if (count == 0) return;
  if (count > kNamed) names += " and " + std::to_string(count - kNamed) + " more";
  log.add(warning("no-points", {{"files", count}}, "{}: no point that can be stored{}", names,
                  count == boxes.size() ? ", so nothing can collide with this store" : ""));
}

}  // namespace

void FileBoxes::add(const QuantaBatch& batch) {
  if (batch.whole.points == 0) return;
  const std::lock_guard lock(mutex_);
  if (boxes_.size() <= batch.file) boxes_.resize(batch.file + 1);
  boxes_[batch.file].add(batch.whole);
}

std::vector<FileBox> FileBoxes::boxes(std::size_t files) const {
  std::vector<FileBox> out = boxes_;
  out.resize(files);
  return out;
}

Box box_of(const FileBox& box, const Quantisation& quantisation) {
  return {position(quantisation, box.lo[0], box.lo[1], box.lo[2]),
          position(quantisation, box.hi[0], box.hi[1], box.hi[2])};
}

std::optional<Box> common_box(std::span<const FileBox> boxes, const Quantisation& quantisation) {
  std::optional<Box> common;
  for (const FileBox& one : boxes) {
    if (one.points == 0) continue;
    const Box box = box_of(one, quantisation);
    common = common ? common->united(box) : box;
  }
  return common;
}

void warn_of_boxes(std::span<const FileBox> boxes, const Quantisation& quantisation,
                   std::span<const std::filesystem::path> files, std::span<const CloudInfo> infos,
                   MessageLog& log) {
  warn_of_empty(boxes, files, log);
  const Inputs inputs(boxes, quantisation, files);
  inputs.warn_of_distance(log);
  inputs.warn_of_size(log);
  BoundsWarnings bounds;
  CutOffWarning cut_off;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const FileBox& box = boxes[i];
    const std::string name = files[i].string();
    if (box.beyond > 0) {
      bounds.add(name, *infos[i].declared_box, {box.points, box.beyond, box_of(box, quantisation)});
    }
    if (!infos[i].quantisation) continue;
    const double* scale = infos[i].quantisation->scale;
    cut_off.add(name, box.cut_off, {scale[0], scale[1], scale[2]});
  }
  for (const Message& message : bounds.messages()) log.add(message);
  if (const auto message = cut_off.message()) log.add(*message);
}

}  // namespace clearway
