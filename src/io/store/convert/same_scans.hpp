#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <span>
#include <vector>

#include "clearway/progress.hpp"
#include "io/store/convert/coordinate_steps.hpp"
#include "io/store/convert/file_boxes.hpp"
#include "io/store/convert/quanta_batch.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// Share of the points above which a warning is due where they are at the same place, provided that
/// they are at least kSamePlacePoints.
inline constexpr double kSamePlaceShare = 0.01;
/// Least number of points at the same place for a warning.
inline constexpr std::uint64_t kSamePlacePoints = 10;

/// A sample of the points: one of every 2^k consecutive ones, chosen by a hash, or all of up to
/// 65,536 points. It shows which places may hold a large share of all points, and in which steps
/// coordinates come (docs/design/conversion.md). Takes constant memory and depends only on the
/// points in their order.
class PlaceSample {
 public:
  PlaceSample() = default;
  explicit PlaceSample(const Quantisation& quantisation) : quantisation_(quantisation) {}

  /// Adds the next points, in order.
  void add(const QuantaBatch& batch);
  /// The places that may hold more than kSamePlaceShare of the points; at most 200.
  std::vector<PlaceQuanta> suspects() const;
  /// The sampled points, in order.
  std::span<const SampledPoint> points() const { return samples_; }

 private:
  static constexpr std::size_t kMostSamples = std::size_t{1} << 16;

  void thin();
  void choose_next();

  Quantisation quantisation_{};
  std::vector<SampledPoint> samples_;
  unsigned level_ = 0;       ///< k, where one of every 2^k points is sampled
  std::uint64_t group_ = 0;  ///< index of the group of 2^k points whose sample is taken next
  std::uint64_t next_ = 0;   ///< index of the point that is sampled next
  std::uint64_t seen_ = 0;
};

/// Counts the points at given places, and in the cubes that show whether steps are those of a
/// raster. add() may be called from several threads.
class PlaceCounter {
 public:
  struct Place {
    PlaceQuanta at{};
    std::uint64_t count = 0;
    std::uint64_t first = 0, last = 0;  ///< source indices of the first and the last point
  };

  /// places: at most 200.
  explicit PlaceCounter(const std::vector<PlaceQuanta>& places, StepJudge steps = {});

  void add(const QuantaBatch& batch);
  const StepJudge& steps() const { return steps_; }
  /// The places for which a warning is due among `points` points, the fullest first.
  std::vector<Place> crowded(std::uint64_t points) const;

  template <typename Values>
  void keep(Values& values) {
    values.add(places_, steps_);
  }

 private:
  std::vector<Place> places_;
  StepJudge steps_;
  std::vector<std::uint16_t> table_;  // by hash: 1 + the place's index, or 0
  std::mutex mutex_;
  std::shared_mutex cubes_mutex_;
};

/// Warns of inputs whose bytes equal those of an earlier one: the same file named twice, or a copy
/// of it. Inputs without points do not count. sources: descriptions of the files as read.
void warn_of_same_scans(std::span<const std::filesystem::path> files,
                        std::span<const SourceFile> sources, std::span<const FileBox> boxes,
                        MessageLog& log);

}  // namespace clearway
