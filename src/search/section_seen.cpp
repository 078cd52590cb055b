#include "search/section_seen.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "clearway/query.hpp"
#include "core/seen/brick_cloud.hpp"
#include "core/seen/brick_map.hpp"
#include "cpu/section_cubes.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/thread_limit.hpp"
#include "search/seen_space.hpp"

namespace clearway {
namespace {

/// The box of range and window, moved along the poses of the load.
Query box_along(std::span<const Pose> load, const SectionLattice& lattice) {
  const double g = lattice.cell;
  const Box box{{lattice.x_from, lattice.j_from * g, lattice.k_from * g},
                {lattice.x_to, lattice.j_to * g, lattice.k_to * g}};
  Query query;
  for (unsigned corner = 0; corner < 8; ++corner) {
    query.model.vertices.push_back(box.corner(corner));
  }
  query.poses.assign(load.begin(), load.end());
  return query;
}

/// More than half the diagonal of a cube.
double radius_around(const CubeLattice& cubes, const Quantisation& quantisation) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += static_cast<double>(cubes.side[k]) * quantisation.scale[k];
  return sum;
}

CubeLattice cubes_of(const StoreReader& store, double side) {
  QueryParameters asked;
  asked.seen = true;
  asked.seen_cube = side;
  check_seen_space(store, asked);
  return cube_lattice(store, side);
}

}  // namespace

SectionSeen::SectionSeen(const StoreReader& store, const SectionParameters& asked,
                         std::span<const Pose> load, const SectionPoses& poses,
                         const SectionLattice& lattice, double rounding, std::uint64_t memory_bytes)
    : store_(store),
      poses_(poses),
      lattice_(lattice),
      rounding_(rounding),
      cubes_(cubes_of(store, asked.seen_cube)) {
  bricks_ = bricks_along(box_along(load, lattice), radius_around(cubes_, store.quantisation()),
                         cubes_, store.quantisation(), memory_bytes);
  const SectionCubes reach(cubes_, store.quantisation(), poses_, lattice_, rounding_);
  std::erase_if(bricks_, [&reach](const Brick& brick) { return !reach.may_reach(brick); });
  bricks_.shrink_to_fit();
}

std::uint64_t SectionSeen::needed_bytes() const {
  return bricks_.size() * sizeof(Brick) + BrickMap::bytes_for(bricks_.size());
}

BeamCounts SectionSeen::block(int threads, SectionMaps& maps, Progress& progress) const {
  BrickMap map(cubes_, bricks_,
               std::vector<std::uint64_t>(bricks_.size() * kBrickWords, ~std::uint64_t{0}));
  const BeamCounts left_out = follow_all_beams(store_, threads, map, progress);
  const SectionCubes search(cubes_, store_.quantisation(), poses_, lattice_, rounding_);
  progress.begin("not known", bricks_.size(), "blocks of cubes");
  in_threads(threads, [&] {
    for_each_parallel(map.bricks().size(), [&](std::size_t i) {
      throw_if_stopped(progress);
      const auto brick = static_cast<std::uint32_t>(i);
      search.search(map.bricks()[brick], map.words(brick), maps);
      progress.advance(1);
    });
  });
  progress.end();
  return left_out;
}

}  // namespace clearway
