// nanoflann: a k-d tree in doubles, one radius search for every pose and model point.

#include "bench/peers/programs/nanoflann_tree.hpp"
#include "bench/peers/programs/peer.hpp"

namespace clearway::bench {
namespace {

/// Marks what a search finds at once, which radiusSearchCustomCallback() is for.
class MarkingResult {
 public:
  MarkingResult(double radius_squared, Marks& marks) : radius_(radius_squared), marks_(marks) {}
  std::size_t size() const { return 0; }
  bool full() const { return true; }
  double worstDist() const { return radius_; }
  bool addPoint(double squared, std::uint32_t index) {
    if (squared < radius_) marks_.mark(index);
    return true;
  }

 private:
  double radius_;
  Marks& marks_;
};

class Nanoflann : public Peer {
 public:
  Nanoflann(std::span<const Vec3> points, const PeerOptions& options)
      : Peer(options, {{"name", "nanoflann"},
                       {"version", CLEARWAY_NANOFLANN_VERSION},
                       {"settings",
                        "double, leaves of 12 points, a callback for each point found, places in "
                        "parallel; the tree is built by one thread"}}),
        adaptor_{points},
        tree_(3, adaptor_, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafPoints)) {
    tree_.buildIndex();
  }

  void search(std::span<const Pose> poses, std::span<const Vec3> model, Marks& marks) override {
    const double radius_squared = rounded_product(options_.radius, options_.radius);
    search_places(poses, model, options_.threads, [&] {
      return [this, result = MarkingResult(radius_squared, marks)](const Vec3& at) mutable {
        const double place[3] = {at.x, at.y, at.z};
#if NANOFLANN_VERSION >= 0x150
        tree_.radiusSearchCustomCallback(place, result);
#else
        tree_.radiusSearchCustomCallback(place, result, nanoflann::SearchParams(0, 0, false));
#endif
      };
    });
  }

 private:
  NanoflannPoints adaptor_;
  NanoflannTree tree_;
};

}  // namespace

std::unique_ptr<Peer> make_peer(std::span<const Vec3> points, const PeerOptions& options) {
  return std::make_unique<Nanoflann>(points, options);
}

}  // namespace clearway::bench
