#include "scene/scanning/fan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/vector.hpp"

namespace clearway::scene {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

struct Interval {
  double low, high;
  bool empty() const { return !(low < high); }
};

/// The interval of h in which |start + h * direction| < half.
Interval within_slab(double start, double direction, double half) {
  if (std::abs(direction) < 1e-12) {
    return std::abs(start) < half ? Interval{-kFar, kFar} : Interval{0, 0};
  }
  const double a = (-half - start) / direction, b = (half - start) / direction;
  return {std::min(a, b), std::max(a, b)};
}

Interval within_circle(double x, double y, const SineCosine& direction, double radius) {
  const double along = x * direction.cosine + y * direction.sine;
  const double across = x * direction.sine - y * direction.cosine;
  const double square = radius * radius - across * across;
  if (square <= 0) return {0, 0};
  const double half = std::sqrt(square);
  return {-along - half, -along + half};
}

Interval cut(const Prism& prism, const PathPoint& scanner, const SineCosine& azimuth) {
  const double x = scanner.s - prism.s, y = scanner.v - prism.v;
  if (prism.round) return within_circle(x, y, azimuth, prism.half_length);
  const double c = prism.turn.cosine, s = prism.turn.sine;
  const Interval a =
      within_slab(c * x + s * y, c * azimuth.cosine + s * azimuth.sine, prism.half_length);
  const Interval b =
      within_slab(c * y - s * x, c * azimuth.sine - s * azimuth.cosine, prism.half_width);
  return {std::max(a.low, b.low), std::min(a.high, b.high)};
}

/// The angle of a corner from straight down, 0 to 2 pi; straight down is 2 pi for the left half.
/// Only good for choosing rays to test, with a margin, because atan2 may differ between machines.
double corner_angle(double h, double w, bool left) {
  const double angle = std::atan2(h, -w);
  return angle < 0 || (left && angle == 0) ? angle + 2 * kPi : angle;
}

}  // namespace

void cut_prisms(std::span<const Prism> prisms, const PathPoint& scanner, const SineCosine& azimuth,
                std::vector<Rectangle>& out) {
  for (const Prism& prism : prisms) {
    const Interval h = cut(prism, scanner, azimuth);
    if (h.empty()) continue;
    const double low = prism.bottom - scanner.w, high = prism.top - scanner.w;
    if (h.low >= 0 || h.high <= 0 || low >= 0) {
      out.push_back({h.low, h.high, low, high, &prism});
    } else if (high <= 0) {
      out.push_back({h.low, 0, low, high, &prism});
      out.push_back({0, h.high, low, high, &prism});
    }
  }
}

void Fan::aim(double begin, double end, std::size_t count, const Random& random,
              std::uint64_t first_counter) {
  begin_ = begin;
  step_ = (end - begin) / static_cast<double>(std::max<std::size_t>(count, 1));
  for (auto* list : {&ray_h_, &ray_w_, &inverse_h_, &inverse_w_}) list->resize(count);
  inverse_distance_.assign(count, 0);
  wall_.assign(count, -1);
  prism_.assign(count, nullptr);
  constexpr double kLeast = 1e-9;  // keeps the inverses of directions finite
  for (std::size_t k = 0; k < count; ++k) {
    const double at = static_cast<double>(k) + random.unit(first_counter + k);
    const SineCosine angle = sine_cosine(begin + at * step_);
    const double h = angle.sine, w = -angle.cosine;
    ray_h_[k] = std::abs(h) < kLeast ? kLeast : h;
    ray_w_[k] = std::abs(w) < kLeast ? kLeast : w;
    inverse_h_[k] = 1 / ray_h_[k];
    inverse_w_[k] = 1 / ray_w_[k];
  }
}

void Fan::meet_room(const Room& room, const PathPoint& scanner, const SineCosine& azimuth) {
  room_ = &room;
  for (std::size_t i = 0; i < room.walls.size(); ++i) {
    const Wall& wall = room.walls[i];
    const double left = wall.distance - wall.normal_v * scanner.v - wall.normal_w * scanner.w;
    const double a = wall.normal_v * azimuth.sine / left, b = wall.normal_w / left;
    const int number = static_cast<int>(i);
    for (std::size_t k = 0; k < size(); ++k) {
      const double inverse = a * ray_h_[k] + b * ray_w_[k];
      const bool nearer = inverse > inverse_distance_[k];
      inverse_distance_[k] = nearer ? inverse : inverse_distance_[k];
      wall_[k] = nearer ? number : wall_[k];
    }
  }
}

void Fan::meet_rectangle(const Rectangle& r) {
  const bool left = r.near_h < 0 && r.far_h <= 0;
  double low = 7, high = -1;
  for (const double h : {r.near_h, r.far_h}) {
    for (const double w : {r.low_w, r.high_w}) {
      const double angle = corner_angle(h, w, left);
      low = std::min(low, angle);
      high = std::max(high, angle);
    }
  }
  constexpr double kMargin = 2;  // rays: one of jitter, one of rounding
  const auto count = static_cast<double>(size());
  const auto first =
      static_cast<std::size_t>(std::clamp((low - begin_) / step_ - kMargin, 0.0, count));
  const auto last =
      static_cast<std::size_t>(std::clamp((high - begin_) / step_ + kMargin, 0.0, count));
  for (std::size_t k = first; k < last; ++k) {
    const double h0 = r.near_h * inverse_h_[k], h1 = r.far_h * inverse_h_[k];
    const double w0 = r.low_w * inverse_w_[k], w1 = r.high_w * inverse_w_[k];
    const double enter = std::max(std::min(h0, h1), std::min(w0, w1));
    const double leave = std::min(std::max(h0, h1), std::max(w0, w1));
    if (enter <= leave && enter > 0 && enter * inverse_distance_[k] < 1) {
      inverse_distance_[k] = 1 / enter;
      wall_[k] = -1;
      prism_[k] = r.prism;
    }
  }
}

}  // namespace clearway::scene
