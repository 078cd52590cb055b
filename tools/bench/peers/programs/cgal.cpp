// CGAL: Kd_tree with Fuzzy_sphere, which is exact in doubles with an epsilon of zero.

#include <CGAL/Fuzzy_sphere.h>
#include <CGAL/Kd_tree.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>
#include <CGAL/version.h>

#include <boost/iterator/function_output_iterator.hpp>
#include <cmath>
#include <tuple>

#include "bench/peers/programs/peer.hpp"

namespace clearway::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Entry = std::tuple<Point, std::uint32_t>;
using Traits = CGAL::Search_traits_adapter<Entry, CGAL::Nth_of_tuple_property_map<0, Entry>,
                                           CGAL::Search_traits_3<Kernel>>;
// Stores the coordinates of a leaf side by side, which the manual advises for speed.
using Tree = CGAL::Kd_tree<Traits, CGAL::Sliding_midpoint<Traits>, CGAL::Tag_true, CGAL::Tag_true>;
using Sphere = CGAL::Fuzzy_sphere<Traits>;

/// What is done with a point that the tree finds.
struct Marker {
  Marks* marks;
  void operator()(const Entry& entry) const { marks->mark(std::get<1>(entry)); }
};

class Cgal : public Peer {
 public:
  Cgal(std::span<const Vec3> points, const PeerOptions& options)
      : Peer(options, {{"name", "CGAL"},
                       {"version", CGAL_VERSION_STR},
                       {"settings",
                        "Kd_tree of doubles with cached coordinates, built by all threads, "
                        "Fuzzy_sphere with epsilon 0, places in parallel"}}) {
    std::vector<Entry> entries;
    entries.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      entries.emplace_back(Point(points[i].x, points[i].y, points[i].z),
                           static_cast<std::uint32_t>(i));
    }
    tree_.insert(entries.begin(), entries.end());
    tree_.build<CGAL::Parallel_tag>();
  }

  void search(std::span<const Pose> poses, std::span<const Vec3> model, Marks& marks) override {
    // A sphere includes its boundary, so the largest radius below ours gives what is nearer.
    const double radius = std::nextafter(options_.radius, 0.0);
    search_places(poses, model, options_.threads, [&] {
      const auto mark = boost::make_function_output_iterator(Marker{&marks});
      return [this, mark, radius](const Vec3& at) {
        tree_.search(mark, Sphere(Point(at.x, at.y, at.z), radius, 0.0, tree_.traits()));
      };
    });
  }

 private:
  Tree tree_;
};

}  // namespace

std::unique_ptr<Peer> make_peer(std::span<const Vec3> points, const PeerOptions& options) {
  return std::make_unique<Cgal>(points, options);
}

}  // namespace clearway::bench
