#include "io/convert/checks/choose_scale.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/util/format.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

constexpr double kGreatestQuantum = std::numeric_limits<std::int32_t>::max();
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

class Choice {
 public:
  Choice(const CoordinateRange& range, std::span<const std::filesystem::path> files,
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
                           brief(out.scale[axis]) + far_points(),
                       Remedy::kScale, fits(length, fitting) ? fitting : 0);
    }
    if (!scale && fitting > kCoarsestOwnScale) {
      throw InputError(reach(axis) + " need steps of " + brief(fitting) + " m; expected at most " +
                           brief(kCoarsestOwnScale) + " m" + far_points(),
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
    return text + ": coordinates " + name + " from " + brief(range_.lo(axis)) + " to " +
           brief(range_.hi(axis));
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
           ": " + brief(p.at.x) + " " + brief(p.at.y) + " " + brief(p.at.z);
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
    return text + ". Without them steps of " + brief(rest) + " m do";
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
  const Choice choice(range, files, how_to_read);
  for (int axis = 0; axis < 3; ++axis) choice.choose(axis, scale, out);
  return out;
}

}  // namespace clearway
