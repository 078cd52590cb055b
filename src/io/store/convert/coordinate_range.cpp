#include "io/store/convert/coordinate_range.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <tuple>

#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/store/convert/read_points.hpp"

namespace clearway {
namespace {

bool comes_before(const InputPoint& a, const InputPoint& b) {
  return std::tie(a.file, a.point) < std::tie(b.file, b.point);
}

bool is_same(const InputPoint& a, const InputPoint& b) {
  return a.file == b.file && a.point == b.point;
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
  for (int axis = 0; axis < 3; ++axis) {
    const auto& least = extremes_[side(axis, false)];
    const auto& greatest = extremes_[side(axis, true)];
    if (least.size() < kKept || p[axis] < least.back().at[axis]) {
      keep(side(axis, false), axis, false, {p, file, point});
    }
    if (greatest.size() < kKept || p[axis] > greatest.back().at[axis]) {
      keep(side(axis, true), axis, true, {p, file, point});
    }
  }
}

void CoordinateRange::keep(std::size_t side, int axis, bool greatest, const InputPoint& p) {
  auto& kept = extremes_[side];
  if (kept.size() == kKept) kept.pop_back();
  const auto behind = [=](const InputPoint& a, const InputPoint& b) {
    return greatest ? a.at[axis] > b.at[axis] : a.at[axis] < b.at[axis];
  };
  kept.insert(std::upper_bound(kept.begin(), kept.end(), p, behind), p);
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
  for (int axis = 0; axis < 3; ++axis) {
    const double middle = median(axis);
    for (const bool greatest : {false, true}) {
      const auto& kept = extremes_[side(axis, greatest)];
      const auto is_far = [&](const InputPoint& p) {
        return std::abs(p.at[axis] - middle) > reach;
      };
      std::copy_if(kept.begin(), kept.end(), std::back_inserter(far.points), is_far);
      far.more = far.more || std::all_of(kept.begin(), kept.end(), is_far);
    }
  }
  std::sort(far.points.begin(), far.points.end(), comes_before);
  far.points.erase(std::unique(far.points.begin(), far.points.end(), is_same), far.points.end());
  for (int axis = 0; axis < 3 && !far.more; ++axis) {
    for (const bool greatest : {false, true}) {
      const auto& kept = extremes_[side(axis, greatest)];
      const auto rest = std::find_if(kept.begin(), kept.end(), [&](const InputPoint& p) {
        return !std::binary_search(far.points.begin(), far.points.end(), p, comes_before);
      });
      far.more = far.more || rest == kept.end();
      if (rest != kept.end()) (greatest ? far.hi : far.lo)[axis] = rest->at[axis];
    }
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
