#include "io/store/convert/coordinate_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

#include "core/geometry/inside.hpp"
#include "core/util/format.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway {
namespace {

// An axis with at most this many values, as in a flat scan, has lost nothing.
constexpr std::size_t kFewValues = 8;
constexpr std::size_t kFewSamples = 256;
constexpr std::size_t kMostGaps = 256;  // number of lengths that are tried as the step
constexpr double kOffSteps = 0.01;      // greatest share of values that are off the steps
// Metres. Whole centimetres are usual and not suspicious, and no raster is that fine.
constexpr double kUsualStep = 0.01;

/// A value of an axis, and how many sampled points have it.
struct AxisValue {
  std::int32_t at;
  std::uint32_t points;
};

std::vector<AxisValue> distinct(std::vector<std::int32_t> values) {
  std::ranges::sort(values);
  std::vector<AxisValue> out;
  for (const std::int32_t at : values) {
    if (out.empty() || out.back().at != at) out.push_back({at, 0});
    ++out.back().points;
  }
  return out;
}

/// How far a value may be from a multiple of a step, because both were rounded.
double tolerance_of(double step) { return step < 4 ? 0 : std::max(1.0, 0.01 * step); }

/// Tries a length as the step of values, and makes it more exact on the way.
class Fit {
 public:
  /// points: number of all sampled points.
  Fit(const std::vector<AxisValue>& values, std::size_t points, std::size_t reference,
      double length)
      : values_(values),
        first_(values[reference].at),
        step_(length),
        most_off_(kOffSteps * static_cast<double>(points)) {
    fits_ = extend(reference, 1) && extend(reference, -1) && holds();
  }

  bool fits() const { return fits_; }
  ValueSteps steps() const { return {step_, first_}; }

 private:
  /// Goes through the values on one side of the reference. The farther the multiples that are known
  /// the more exact is the step.
  bool extend(std::size_t reference, int direction) {
    const auto size = static_cast<std::ptrdiff_t>(values_.size());
    for (auto i = static_cast<std::ptrdiff_t>(reference) + direction; i >= 0 && i < size;
         i += direction) {
      const AxisValue& value = values_[static_cast<std::size_t>(i)];
      const double distance = std::abs(value.at - first_);
      const double multiple = std::round(distance / step_);
      const double off = std::abs(distance - multiple * step_);
      const double tolerance = tolerance_of(step_);
      const double allowed = tolerance * (1 + multiple / reach_);
      if (off <= tolerance || (off <= allowed && allowed < step_ / 2)) {
        if (tolerance == 0 || multiple <= reach_) continue;
        step_ = distance / multiple;
        reach_ = multiple;
      } else if ((off_ += value.points) > most_off_) {
        return false;
      }
    }
    return true;
  }

  /// Whether the values are at more than a few multiples of the step, which becomes that of the
  /// line through them.
  bool holds() {
    std::size_t different = 0;
    double last = std::numeric_limits<double>::quiet_NaN();
    double off = 0, points = 0, multiples = 0, squares = 0, products = 0, sum = 0;
    for (const AxisValue& value : values_) {
      const double distance = value.at - first_;
      const double multiple = std::round(distance / step_);
      if (std::abs(distance - multiple * step_) > 1.5 * tolerance_of(step_)) {
        off += value.points;
        continue;
      }
      different += multiple == last ? 0 : 1;
      last = multiple;
      points += value.points;
      multiples += value.points * multiple;
      squares += value.points * multiple * multiple;
      products += value.points * multiple * distance;
      sum += value.points * distance;
    }
    const double spread = points * squares - multiples * multiples;
    if (tolerance_of(step_) > 0 && spread > 0) {
      step_ = (points * products - multiples * sum) / spread;
      first_ += (sum - step_ * multiples) / points;
    }
    return different > kFewValues && off <= most_off_;
  }

  const std::vector<AxisValue>& values_;
  double first_, step_, most_off_;
  double reach_ = 1;  ///< the greatest multiple that has been found
  double off_ = 0;
  bool fits_ = false;
};

}  // namespace

PlaceQuanta measured(const QuantaBatch& batch, const PlaceQuanta& q,
                     const Quantisation& quantisation) {
  if (!batch.turn) return q;
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  const Vec3 p = pulled_back(*batch.turn, position(quantisation, q[0], q[1], q[2]));
  PlaceQuanta out;
  for (std::size_t k = 0; k < 3; ++k) {
    const double quantum = std::nearbyint(p[static_cast<int>(k)] / quantisation.scale[k]);
    out[k] = static_cast<std::int32_t>(std::clamp(quantum, -kMost, kMost));
  }
  return out;
}

ValueSteps steps_of(std::vector<std::int32_t> all) {
  const std::size_t points = all.size();
  if (points < kFewSamples) return {};
  const std::vector<AxisValue> values = distinct(std::move(all));
  if (values.size() <= kFewValues) return {};
  // By length: the gap whose two values have most points, which are hardly stray ones.
  std::map<std::int64_t, std::size_t> gaps;
  const auto weight = [&](std::size_t i) {
    return std::min(values[i].points, values[i + 1].points);
  };
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    const auto [gap, is_new] = gaps.try_emplace(std::int64_t{values[i + 1].at} - values[i].at, i);
    if (!is_new && weight(i) > weight(gap->second)) gap->second = i;
    if (gaps.size() > kMostGaps) gaps.erase(std::prev(gaps.end()));
  }
  ValueSteps found{1, 0};
  for (const auto& [length, at] : gaps) {
    const Fit fit(values, points, at, static_cast<double>(length));
    if (fit.fits()) found = fit.steps();
  }
  return found;
}

std::vector<InputSteps> find_steps(std::span<const SampledPoint> samples,
                                   std::span<const std::uint64_t> points_of_files) {
  std::vector<InputSteps> out;
  std::uint64_t end = 0;
  auto next = samples.begin();
  std::array<std::vector<std::int32_t>, 3> values;
  bool is_turned = false;
  for (std::size_t file = 0; file < points_of_files.size(); ++file) {
    end += points_of_files[file];
    for (; next != samples.end() && next->file == file; ++next) {
      for (std::size_t k = 0; k < 3; ++k) values[k].push_back(next->measured[k]);
      is_turned = is_turned || next->is_turned;
    }
    if (values[0].size() < kFewSamples && file + 1 < points_of_files.size()) continue;
    InputSteps input{.end = end, .is_turned = std::exchange(is_turned, false)};
    for (std::size_t k = 0; k < 3; ++k) {
      input.axes[k] = steps_of(std::exchange(values[k], {}));
    }
    out.push_back(input);
  }
  return out;
}

std::size_t CubeSample::Hash::operator()(const Cube& cube) const {
  std::uint64_t hash = static_cast<std::uint64_t>(cube[0]) * 0x9E3779B97F4A7C15 +
                       static_cast<std::uint64_t>(cube[1]) * 0xC2B2AE3D27D4EB4F +
                       static_cast<std::uint64_t>(cube[2]) * 0x165667B19E3779F9;
  hash = (hash ^ (hash >> 30)) * 0xBF58476D1CE4E5B9;  // the mixer of splitmix64
  hash = (hash ^ (hash >> 27)) * 0x94D049BB133111EB;
  return hash ^ (hash >> 31);
}

/// Cubes are chosen in blocks of eight, so that the ones beside a cube are chosen with it.
bool CubeSample::is_chosen(const Cube& cube, unsigned level) {
  if (level == 0) return true;
  const Cube block{cube[0] >> 1, cube[1] >> 1, cube[2] >> 1};
  return Hash()(block) >> (64 - level) == 0;
}

void CubeSample::add(const Cube& cube) {
  if (!may_hold(cube)) return;
  ++cubes_[cube];
  while (cubes_.size() > kMostCubes) {
    ++level_;
    std::erase_if(cubes_, [this](const auto& counted) { return !may_hold(counted.first); });
  }
}

bool CubeSample::is_raster() const {
  constexpr double kRare = 0.005;
  double points = 0, neighbours = 0;
  for (const auto& [cube, count] : cubes_) {
    points += static_cast<double>(count);
    for (std::size_t k = 0; k < 3; ++k) {
      Cube beside = cube;
      beside[k] ^= 1;
      neighbours += cubes_.contains(beside) ? 1.0 / 3 : 0;
    }
  }
  const auto cubes = static_cast<double>(cubes_.size());
  if (cubes == 0) return false;
  return 1 - cubes / points <= std::max(kRare, neighbours / cubes / 4);
}

StepJudge::StepJudge(std::vector<InputSteps> inputs, const Quantisation& quantisation, double metre)
    : inputs_(std::move(inputs)), quantisation_(quantisation), metre_(metre) {
  for (std::uint32_t i = 0; i < inputs_.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double edge = length_of(inputs_[i], axis);
      if (edge <= kUsualStep * metre * (1 + 1e-6)) continue;
      const auto same = std::ranges::find_if(cubes_, [&](const Sampled& sampled) {
        return sampled.input == i && std::abs(sampled.edge - edge) <= 1e-6 * edge;
      });
      Sampled& sampled = same == cubes_.end() ? cubes_.emplace_back(Sampled{i, edge}) : *same;
      sampled.axes[axis] = true;
    }
  }
}

void StepJudge::add(const QuantaBatch& batch, std::shared_mutex& mutex) {
  if (cubes_.empty() || batch.quanta.empty()) return;
  const auto input = std::ranges::upper_bound(inputs_, batch.source(0), {}, &InputSteps::end);
  // A batch that is counted after a resumption does not say how it was turned.
  if (input == inputs_.end() || (input->is_turned && !batch.turn)) return;
  for (Sampled& sampled : cubes_) {
    if (&inputs_[sampled.input] != &*input) continue;
    std::array<double, 3> cubes_per_quantum{};
    for (std::size_t k = 0; k < 3; ++k) {
      cubes_per_quantum[k] = quantisation_.scale[k] / sampled.edge;
    }
    std::vector<CubeSample::Cube> cubes;
    std::shared_lock reading(mutex);
    for (const auto& at : batch.quanta) {
      const PlaceQuanta q = measured(batch, at, quantisation_);
      CubeSample::Cube cube;
      for (std::size_t k = 0; k < 3; ++k) {
        cube[k] = std::llrint((q[k] - input->axes[k].first) * cubes_per_quantum[k]);
      }
      if (sampled.sample.may_hold(cube)) cubes.push_back(cube);
    }
    reading.unlock();
    const std::lock_guard writing(mutex);
    for (const CubeSample::Cube& cube : cubes) sampled.sample.add(cube);
  }
}

bool StepJudge::is_raster(std::size_t input, std::size_t axis) const {
  return std::ranges::any_of(cubes_, [&](const Sampled& sampled) {
    return sampled.input == input && sampled.axes[axis] && sampled.sample.is_raster();
  });
}

template <typename Counts>
double StepJudge::coarsest(std::size_t axis, Counts counts) const {
  double longest = 0;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      // Where points were turned, each axis of the scanner is part of every axis of the store.
      const bool is_part = k == axis || inputs_[i].is_turned;
      if (is_part && counts(i, k)) longest = std::max(longest, length_of(inputs_[i], k));
    }
  }
  return longest;
}

std::array<double, 3> StepJudge::rounded_to() const {
  std::array<double, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = coarsest(k, [&](std::size_t i, std::size_t axis) { return !is_raster(i, axis); });
  }
  return out;
}

std::optional<Message> StepJudge::warning_on_lost_digits(LengthUnit unit) const {
  const std::string symbol =
      unit == LengthUnit::kFoot || unit == LengthUnit::kUsSurveyFoot ? " ft" : " m";
  std::string axes, steps;
  double longest = 0;
  bool all_rasters = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const double length = coarsest(k, [&](std::size_t i, std::size_t axis) {
      const bool is_coarse = inputs_[i].axes[axis].step > 1 &&
                             length_of(inputs_[i], axis) > kUsualStep * metre_ * (1 + 1e-6);
      if (is_coarse) all_rasters = all_rasters && is_raster(i, axis);
      return is_coarse;
    });
    if (length == 0) continue;
    axes += std::string(axes.empty() ? "" : ", ") + "xyz"[k];
    steps += (steps.empty() ? "" : ", ") + format_digits(length, 6) + symbol;
    longest = std::max(longest, length);
  }
  if (longest == 0) return std::nullopt;
  return warning(
      "lost-digits", {{"step", longest}, {"raster", all_rasters ? 1.0 : 0.0}},
      "all coordinates {} come in steps of {}{}{}{}. Export the scan with more digits", axes, steps,
      all_rasters ? ". There is about one point for each step, as in a regular raster: where the "
                    "scan was denser, points may be wrong by "
                  : ". Rounded text, single floats or a coarse export have lost their digits, so "
                    "points may be wrong by ",
      format_digits(longest / 2, 6), symbol);
}

}  // namespace clearway
