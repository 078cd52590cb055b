#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <shared_mutex>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "clearway/progress.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/store/convert/quanta_batch.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// A place in the store's integers.
using PlaceQuanta = std::array<std::int32_t, 3>;

/// A sampled point of an input.
struct SampledPoint {
  PlaceQuanta at{};
  PlaceQuanta measured{};  ///< see measured()
  std::uint32_t file = 0;
  bool is_turned = false;  ///< whether both differ by a pose that was applied
};

/// The integers of a batch's point as it was measured: before a pose turned it.
PlaceQuanta measured(const QuantaBatch& batch, const PlaceQuanta& q,
                     const Quantisation& quantisation);

/// The steps in which values come: all are `first` plus a multiple of `step`, but for their
/// rounding to the store's integers and for 1 % of them. Both are in the store's integers.
struct ValueSteps {
  double step = 0;  ///< 0 where so few values do not show a step
  double first = 0;
};

/// The coarsest steps that the values show.
ValueSteps steps_of(std::vector<std::int32_t> values);

/// The steps of each axis of an input, or of several small ones.
struct InputSteps {
  std::uint64_t end = 0;  ///< source index after the last of their points
  std::array<ValueSteps, 3> axes{};
  /// Whether a pose turned the points. The axes are those before it, as a scanner has them.
  bool is_turned = false;
};

/// The steps of all inputs, in their order. samples: points in the order of the inputs.
/// points_of_files: the number of source indices that each input takes.
std::vector<InputSteps> find_steps(std::span<const SampledPoint> samples,
                                   std::span<const std::uint64_t> points_of_files);

/// Counts points in cubes, of which it keeps a part that a hash chooses, in constant memory and
/// whatever the order of the points.
class CubeSample {
 public:
  using Cube = std::array<std::int64_t, 3>;
  static constexpr std::size_t kMostCubes = std::size_t{1} << 13;

  /// Whether the sample may hold this cube.
  bool may_hold(const Cube& cube) const { return is_chosen(cube, level_); }
  void add(const Cube& cube);
  /// Whether the cubes hold one point each, as those of a raster do: points that were rounded share
  /// a cube as often as they have one in the cube beside it.
  bool is_raster() const;

  template <typename Values>
  void keep(Values& values) {
    std::vector<std::pair<Cube, std::uint64_t>> all(cubes_.begin(), cubes_.end());
    values.add(level_, all);
    cubes_ = {all.begin(), all.end()};
  }

 private:
  struct Hash {
    std::size_t operator()(const Cube& cube) const;
  };

  static bool is_chosen(const Cube& cube, unsigned level);

  unsigned level_ = 0;  ///< one of 2^level blocks of eight cubes is chosen
  std::unordered_map<Cube, std::uint64_t, Hash> cubes_;
};

/// Tells steps that come from rounding from those of a regular raster, such as a terrain model or
/// the centres of voxels (docs/design/conversion.md).
class StepJudge {
 public:
  StepJudge() = default;
  /// metre: the length of a metre in the unit of the coordinates.
  StepJudge(std::vector<InputSteps> inputs, const Quantisation& quantisation, double metre);

  /// Counts the points of a batch. Several threads may call it at once with the same mutex, in any
  /// order of the batches.
  void add(const QuantaBatch& batch, std::shared_mutex& mutex);

  /// The coarsest steps of each axis that come from rounding, in the unit of the coordinates; 0
  /// where an axis shows none.
  std::array<double, 3> rounded_to() const;
  /// The warning on axes with steps above a centimetre that are coarser than the store's integers;
  /// nullopt where there is none.
  std::optional<Message> warning_on_lost_digits(LengthUnit unit) const;

  template <typename Values>
  void keep(Values& values) {
    values.add(cubes_);
  }

 private:
  struct Sampled {
    std::uint32_t input = 0;
    double edge = 0;             ///< of the cubes, in the unit of the coordinates
    std::array<bool, 3> axes{};  ///< those that come in steps of this length
    CubeSample sample{};

    template <typename Values>
    void keep(Values& values) {
      values.add(input, edge, axes, sample);
    }
  };

  double length_of(const InputSteps& input, std::size_t axis) const {
    return input.axes[axis].step * quantisation_.scale[axis];
  }
  bool is_raster(std::size_t input, std::size_t axis) const;
  /// The coarsest step of an axis of the store that `counts`.
  template <typename Counts>
  double coarsest(std::size_t axis, Counts counts) const;

  std::vector<InputSteps> inputs_;
  Quantisation quantisation_{};
  double metre_ = 1;
  std::vector<Sampled> cubes_;
};

}  // namespace clearway
