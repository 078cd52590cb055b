#include "io/store/convert/coordinate_range.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/store/convert/read_points.hpp"

namespace clearway {
namespace {

/// The number of a point among those of all inputs, by which they are in order.
std::pair<std::size_t, std::uint64_t> number_of(const InputPoint& p) { return {p.file, p.point}; }

int axis_of(std::size_t side) { return static_cast<int>(side / 2); }

/// Whether a point lies farther out than another one on this side.
bool is_beyond(std::size_t side, const Vec3& a, const Vec3& b) {
  const int axis = axis_of(side);
  return side % 2 == 0 ? a[axis] < b[axis] : a[axis] > b[axis];
}

}  // namespace

void CoordinateRange::add(const Vec3& p, std::size_t file, std::uint64_t point) {
  if ((count_++ & sample_mask_) == 0) {
    if (samples_.size() == kMostSamples) {
      for (std::size_t i = 0; 2 * i < samples_.size(); ++i) samples_[i] = samples_[2 * i];
      samples_.resize(samples_.size() / 2);
      sample_mask_ = 2 * sample_mask_ + 1;
    }
    samples_.push_back(p);
  }
  for (std::size_t side = 0; side < extremes_.size(); ++side) {
    const auto& kept = extremes_[side];
    if (kept.size() < kKept || is_beyond(side, p, kept.back().at)) keep(side, {p, file, point});
  }
}

void CoordinateRange::keep(std::size_t side, const InputPoint& p) {
  auto& kept = extremes_[side];
  if (kept.size() == kKept) kept.pop_back();
  const auto behind = [side](const InputPoint& a, const InputPoint& b) {
    return is_beyond(side, a.at, b.at);
  };
  kept.insert(std::ranges::upper_bound(kept, p, behind), p);
}

double CoordinateRange::median(int axis) const {
  std::vector<double> values;
  for (const Vec3& p : samples_) values.push_back(p[axis]);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

CoordinateRange::Far CoordinateRange::far_points(double reach) const {
  Far far;
  if (empty()) return far;
  for (std::size_t side = 0; side < extremes_.size(); ++side) {
    const double middle = median(axis_of(side));
    const auto is_near = [&](const InputPoint& p) {
      return std::abs(p.at[axis_of(side)] - middle) <= reach;
    };
    const auto& kept = extremes_[side];
    std::ranges::remove_copy_if(kept, std::back_inserter(far.points), is_near);
    far.more = far.more || std::ranges::none_of(kept, is_near);
  }
  std::ranges::sort(far.points, {}, number_of);
  const auto again = std::ranges::unique(far.points, {}, number_of);
  far.points.erase(again.begin(), again.end());
  for (std::size_t side = 0; side < extremes_.size() && !far.more; ++side) {
    const auto rest = std::ranges::find_if_not(extremes_[side], [&](const InputPoint& p) {
      return std::ranges::binary_search(far.points, number_of(p), {}, number_of);
    });
    far.more = rest == extremes_[side].end();
    if (!far.more) (side % 2 == 0 ? far.lo : far.hi)[axis_of(side)] = rest->at[axis_of(side)];
  }
  return far;
}

namespace {

constexpr double kScales[] = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1e0, 1e1, 1e2, 1e3};
constexpr std::size_t kShown = 5;  // number of far points that a message names

bool fits(double length, double scale) { return length / scale <= kGreatestQuantum; }

/// The finest power of ten >= 1e-6 at which `length` fits int32; the coarsest of the table where
/// none does.
double fitting_scale(double length) {
  const auto* found = std::find_if(std::begin(kScales), std::end(kScales),
                                   [length](double scale) { return fits(length, scale); });
  return found == std::end(kScales) ? *std::prev(found) : *found;
}

class ScaleChoice {
 public:
  ScaleChoice(const CoordinateRange& range, std::span<const std::filesystem::path> files,
              const PointReadOptions& how_to_read)
      : range_(range), files_(files), how_to_read_(how_to_read) {}

  void choose(int axis, std::optional<double> scale, Quantisation& out) const {
    const double offset = range_.empty() ? 0 : std::floor(range_.lo(axis));
    const double length = range_.empty() ? 0 : range_.hi(axis) - offset;
    const double fitting = fitting_scale(length);
    out.offset[axis] = offset;
    out.scale[axis] = scale.value_or(fitting);
    if (!fits(length, out.scale[axis])) {
      throw InputError(reach(axis) + " do not fit 32-bit integers at a scale of " +
                           format_digits(out.scale[axis], 9) + far_points(),
                       Remedy::kScale, fits(length, fitting) ? fitting : 0);
    }
    if (!scale && fitting > kCoarsestOwnScale) {
      throw InputError(reach(axis) + " need steps of " + format_digits(fitting, 9) +
                           " m; expected at most " + format_digits(kCoarsestOwnScale, 9) + " m" +
                           far_points(),
                       Remedy::kAcceptScale, coarsest_needed());
    }
  }

 private:
  std::string reach(int axis) const {
    const InputPoint& lo = range_.extreme(axis, false);
    const InputPoint& hi = range_.extreme(axis, true);
    const char name = static_cast<char>('x' + axis);
    std::string text = files_[lo.file].string();
    if (hi.file != lo.file) text += " and " + files_[hi.file].string();
    return text + ": coordinates " + name + " from " + format_digits(range_.lo(axis), 9) + " to " +
           format_digits(range_.hi(axis), 9);
  }

  /// The finest scale that fits all axes.
  double coarsest_needed() const {
    double coarsest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      coarsest = std::max(coarsest, fitting_scale(range_.hi(axis) - std::floor(range_.lo(axis))));
    }
    return coarsest;
  }

  /// A point in words: "line 7 (1, 2, 3)", or "point 7" counted from 0, with the file where there
  /// are several.
  std::string place_of(const InputPoint& p) const {
    const auto reader = open_point_file(files_[p.file], how_to_read_);
    const auto lines = reader->lines_of({&p.point, 1});
    return (files_.size() > 1 ? files_[p.file].string() + " " : std::string()) +
           (lines.empty() ? "point " + format_count(p.point) + " (counted from 0)"
                          : "line " + std::to_string(lines[0])) +
           ": " + format_digits(p.at.x, 9) + " " + format_digits(p.at.y, 9) + " " +
           format_digits(p.at.z, 9);
  }

  std::string far_points() const {
    const double reach = kGreatestQuantum * kCoarsestOwnScale / 2;
    const CoordinateRange::Far far = range_.far_points(reach);
    if (far.points.empty()) return "";
    std::string text = ". Far from most others: ";
    const std::size_t shown = std::min(kShown, far.points.size());
    for (std::size_t i = 0; i < shown; ++i) {
      text += (i > 0 ? "; " : "") + place_of(far.points[i]);
    }
    if (far.more) return text + "; and more";
    if (far.points.size() > shown) {
      text += "; and " + std::to_string(far.points.size() - shown) + " more";
    }
    double rest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      rest = std::max(rest, fitting_scale(far.hi[axis] - std::floor(far.lo[axis])));
    }
    return text + ". Without them steps of " + format_digits(rest, 9) + " m do";
  }

  const CoordinateRange& range_;
  std::span<const std::filesystem::path> files_;
  const PointReadOptions& how_to_read_;
};

}  // namespace

Quantisation choose_scale(const CoordinateRange& range, std::optional<double> scale,
                          std::span<const std::filesystem::path> files,
                          const PointReadOptions& how_to_read) {
  Quantisation out{};
  const ScaleChoice choice(range, files, how_to_read);
  for (int axis = 0; axis < 3; ++axis) choice.choose(axis, scale, out);
  return out;
}

}  // namespace clearway
