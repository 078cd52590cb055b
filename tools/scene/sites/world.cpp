#include "scene/sites/world.hpp"

#include <algorithm>
#include <cmath>

namespace clearway::scene {
namespace {

double radius_of(const Prism& prism) {
  if (prism.round) return prism.half_length;
  return std::sqrt(prism.half_length * prism.half_length + prism.half_width * prism.half_width);
}

}  // namespace

void World::add_everywhere(double left, double right, double bottom, double top, Roughness rough) {
  constexpr double kBeyondAnyPath = 1e6;
  everywhere_.push_back(
      box(0, (left + right) / 2, kBeyondAnyPath, (right - left) / 2, bottom, top, rough));
}

void World::finish(const Path& path, double reach) {
  for (const Prism& prism : prisms_)
    greatest_radius_ = std::max(greatest_radius_, radius_of(prism));
  if (path.closed()) {
    const double seam = reach + greatest_radius_;
    for (std::size_t i = 0, n = prisms_.size(); i < n; ++i) {
      Prism image = prisms_[i];
      if (image.s < seam)
        image.s += path.length();
      else if (image.s > path.length() - seam)
        image.s -= path.length();
      else
        continue;
      prisms_.push_back(image);
    }
  }
  std::stable_sort(prisms_.begin(), prisms_.end(),
                   [](const Prism& a, const Prism& b) { return a.s < b.s; });
}

const Room& World::room_at(double s) const {
  const Room* room = &rooms_.front();
  for (const Room& next : rooms_) {
    if (next.begin_s <= s) room = &next;
  }
  return *room;
}

std::span<const Prism> World::prisms_near(double s, double reach) const {
  const double margin = reach + greatest_radius_;
  const auto first = std::lower_bound(prisms_.begin(), prisms_.end(), s - margin,
                                      [](const Prism& prism, double at) { return prism.s < at; });
  const auto last = std::upper_bound(first, prisms_.end(), s + margin,
                                     [](double at, const Prism& prism) { return at < prism.s; });
  return {first, last};
}

}  // namespace clearway::scene
