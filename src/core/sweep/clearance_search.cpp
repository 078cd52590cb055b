#include "core/sweep/clearance_search.hpp"

#include <algorithm>

#include "core/geometry/predicate.hpp"
#include "core/sweep/point_clearance.hpp"

namespace clearway {

template <typename Element>
ClearanceSearchOf<Element>::ClearanceSearchOf(const SweepFilterOf<Element>& filter)
    : sweep_(filter.ref()),
      limit_(rounded_product(sweep_.clearance, sweep_.clearance)),
      guess_(filter.model().element(0)) {}

template <typename Element>
Clearance ClearanceSearchOf<Element>::nearest(const Vec3& e, std::span<const std::uint32_t> nodes,
                                              SweepStatistics& statistics) {
  ++statistics.points_tested;
  if (nodes.empty()) return Clearance{};
  // Pose 0, so that a distance equal to the limit is not an improvement.
  PointClearance<Element> search(sweep_, e, {limit_, 0}, statistics);
  search.offer(guess_pose_, guess_);
  if (guess_is_inside_) search.offer_inside(guess_pose_);
  while (!nodes.empty()) {
    const auto part =
        nodes.first(std::min<std::size_t>(nodes.size(), PointClearance<Element>::kMostNodes));
    search.search(part.data(), static_cast<std::uint32_t>(part.size()));
    nodes = nodes.subspan(part.size());
  }
  if (!(search.best().squared < limit_)) return Clearance{};
  guess_pose_ = search.best().pose;
  guess_is_inside_ = search.is_inside();
  if (!guess_is_inside_) guess_ = search.element();
  return search.best();
}

template class ClearanceSearchOf<Vec3>;
template class ClearanceSearchOf<Triangle>;
template class ClearanceSearchOf<SolidTriangle>;

}  // namespace clearway
