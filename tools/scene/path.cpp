#include "scene/path.hpp"

#include <algorithm>
#include <cmath>

#include "scene/vector.hpp"

namespace clearway::scene {
namespace {

constexpr double kStep = 0.05;
constexpr int kSplineSteps = 2000;  // for each span

/// Points along the uniform cubic B-spline over these control points, first and last the same.
std::vector<Vec3> fine_spline(std::span<const Vec3> control) {
  std::vector<Vec3> out;
  const std::size_t n = control.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (int k = 0; k < kSplineSteps; ++k) {
      const double f = static_cast<double>(k) / kSplineSteps, g = 1 - f, f2 = f * f, f3 = f2 * f;
      out.push_back((1.0 / 6) *
                    ((g * g * g) * control[i] + (3 * f3 - 6 * f2 + 4) * control[(i + 1) % n] +
                     (-3 * f3 + 3 * f2 + 3 * f + 1) * control[(i + 2) % n] +
                     f3 * control[(i + 3) % n]));
    }
  }
  out.push_back(out.front());
  return out;
}

/// Positions at equal arc lengths along a fine polyline, first and last included.
std::vector<Vec3> resampled(const std::vector<Vec3>& line, std::size_t intervals, double step) {
  std::vector<Vec3> out{line.front()};
  double before = 0;
  for (std::size_t i = 1; i < line.size() && out.size() < intervals; ++i) {
    const Vec3 d = line[i] - line[i - 1];
    const double after = before + length(d);
    for (double s = static_cast<double>(out.size()) * step; s <= after && out.size() < intervals;
         s = static_cast<double>(out.size()) * step) {
      out.push_back(line[i - 1] + ((s - before) / (after - before)) * d);
    }
    before = after;
  }
  while (out.size() <= intervals) out.push_back(line.back());
  return out;
}

}  // namespace

Path::Path(std::vector<PathFrame> table, double step, bool closed)
    : table_(std::move(table)),
      step_(step),
      length_(step * static_cast<double>(table_.size() - 1)),
      closed_(closed) {}

Path Path::from_pieces(std::span<const PathPiece> pieces, double slope) {
  constexpr int kSubsteps = 8;
  constexpr double kFine = kStep / kSubsteps;
  double heading = 0, curvature = 0, x = 0, y = 0, s = 0;
  std::vector<PathFrame> table{{{0, 0, 0}, 1, 0}};
  int fine = 0;
  for (const PathPiece& piece : pieces) {
    const auto steps = static_cast<int>(std::lround(piece.length / kFine));
    const double change = (piece.end_curvature - curvature) / steps;
    for (int i = 0; i < steps; ++i) {
      const double middle = heading + (curvature + change / 4) * kFine / 2;
      const SineCosine d = sine_cosine(middle);
      x += d.cosine * kFine;
      y += d.sine * kFine;
      heading += (curvature + change / 2) * kFine;
      curvature += change;
      s += kFine;
      if (++fine % kSubsteps == 0) {
        const SineCosine h = sine_cosine(heading);
        table.push_back({{x, y, slope * s}, h.cosine, h.sine});
      }
    }
  }
  return {std::move(table), kStep, false};
}

Path Path::closed_spline(std::span<const Vec3> control) {
  const std::vector<Vec3> line = fine_spline(control);
  double total = 0;
  for (std::size_t i = 1; i < line.size(); ++i) total += clearway::length(line[i] - line[i - 1]);
  const auto intervals = static_cast<std::size_t>(total / kStep);
  const double step = total / static_cast<double>(intervals);
  const std::vector<Vec3> points = resampled(line, intervals, step);
  std::vector<PathFrame> table;
  for (std::size_t i = 0; i <= intervals; ++i) {
    const Vec3 d = points[i % intervals + 1] - points[(i + intervals - 1) % intervals];
    const Vec3 flat = normalised({d.x, d.y, 0});
    table.push_back({points[i], flat.x, flat.y});
  }
  return {std::move(table), step, true};
}

PathFrame Path::at(double s) const {
  if (closed_) s -= std::floor(s / length_) * length_;
  const double position = s / step_;
  const auto last = static_cast<double>(table_.size() - 2);
  const double index = std::clamp(std::floor(position), 0.0, last);
  const double f = position - index;
  const PathFrame& a = table_[static_cast<std::size_t>(index)];
  const PathFrame& b = table_[static_cast<std::size_t>(index) + 1];
  const Vec3 where = a.position + f * (b.position - a.position);
  if (!(f >= 0)) return {where, a.cos_heading, a.sin_heading};
  if (f > 1) return {where, b.cos_heading, b.sin_heading};
  return {where, a.cos_heading + f * (b.cos_heading - a.cos_heading),
          a.sin_heading + f * (b.sin_heading - a.sin_heading)};
}

Vec3 Path::to_world(const PathPoint& point) const {
  const PathFrame frame = at(point.s);
  return {frame.position.x - point.v * frame.sin_heading,
          frame.position.y + point.v * frame.cos_heading, frame.position.z + point.w};
}

Vec3 Path::direction(double s) const {
  const double half = step_ / 2;
  const PathFrame frame = at(s);
  const double rise = (at(s + half).position.z - at(s - half).position.z) / step_;
  return normalised({frame.cos_heading, frame.sin_heading, rise});
}

}  // namespace clearway::scene
