#include "report/environment_sample.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/files/parallel_loop.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {
namespace {

// Blocks are counted by the logarithm of their surface. A bin is 1/16 of a power of two.
constexpr int kBinsPerOctave = 16, kLeastOctave = -64, kOctaves = 128;
constexpr std::size_t kBins = std::size_t{kBinsPerOctave} * kOctaves;
// Share of the points asked for that is aimed at, because bins are coarser than surfaces.
constexpr double kFill = 0.97;

struct NearBlock {
  /// First point of the block within its cell, and number of its points.
  std::uint32_t first, count;
  /// Square metres, reduced for blocks that are far away.
  double surface;
};

/// The product of a box's two longest sides, because the points of scans lie on surfaces.
double surface_of(const Box& box) {
  std::array<double, 3> side{box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z};
  std::ranges::sort(side);
  return std::max(side[2], 1e-9) * std::max(side[1], 1e-9);
}

std::size_t bin_of(double surface) {
  const double bin = (std::log2(surface) - kLeastOctave) * kBinsPerOctave;
  return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kBins - 1)));
}

double surface_of_bin(std::size_t bin) {
  return std::exp2((static_cast<double>(bin) + 0.5) / kBinsPerOctave + kLeastOctave);
}

class Sampler {
 public:
  Sampler(const StoreReader& store, const PathPlaces& path, const PageLattice& lattice)
      : store_(store), path_(path), lattice_(lattice) {}

  /// Counts the points near the path, and their blocks by surface.
  void count(Progress& progress) {
    progress.begin("environment near the path", store_.cells().size(), "cells");
    places_.resize(store_.cells().size());
    tbb::enumerable_thread_specific<Counts> of_threads;
    for_each_parallel(store_.cells().size(), [&](std::size_t i) {
      throw_if_stopped(progress);
      const auto cell = static_cast<std::uint32_t>(i);
      find_places(cell);
      Counts& counts = of_threads.local();
      visit(cell, [&](const NearBlock& block) {
        counts.points += block.count;
        ++counts.bins[bin_of(block.surface)];
      });
      progress.advance(1);
    });
    for (const Counts& counts : of_threads) {
      counts_.points += counts.points;
      for (std::size_t bin = 0; bin < kBins; ++bin) counts_.bins[bin] += counts.bins[bin];
    }
    progress.end();
  }

  std::uint64_t near_points() const { return counts_.points; }

  /// The area that a point stands for if about `most` points are to be picked.
  double area_for(std::uint64_t most) const {
    double low = 1e-12, high = 1e12;
    for (int i = 0; i < 80; ++i) {
      const double area = std::sqrt(low * high);
      (picked_at(area) > kFill * static_cast<double>(most) ? low : high) = area;
    }
    return high;
  }

  /// Picks points, in no order. area: the area that each stands for, or 0 for all points.
  std::vector<PagePoint> pick(double area, Progress& progress) const {
    tbb::enumerable_thread_specific<std::vector<PagePoint>> of_threads;
    progress.begin("environment points of the page", store_.cells().size(), "cells");
    for_each_parallel(store_.cells().size(), [&](std::size_t cell) {
      throw_if_stopped(progress);
      pick_cell(static_cast<std::uint32_t>(cell), area, of_threads.local());
      progress.advance(1);
    });
    progress.end();
    std::vector<PagePoint> out;
    for (const auto& points : of_threads) out.insert(out.end(), points.begin(), points.end());
    return out;
  }

 private:
  /// The numbers of points near the path, and of their blocks in each bin.
  struct Counts {
    std::uint64_t points = 0;
    std::array<std::uint64_t, kBins> bins{};
  };

  Box box_of(std::uint32_t cell) const {
    return position_box(store_.quantisation(), store_.cells()[cell].box);
  }

  /// Finds the places of the path that a cell is near to and that something in it may be nearest
  /// to.
  void find_places(std::uint32_t cell) {
    path_.near(box_of(cell), places_[cell]);
    path_.keep_nearest(box_of(cell), places_[cell]);
    places_[cell].shrink_to_fit();
  }

  /// Calls visit(block) for each block of a cell that is near the path.
  template <typename Visit>
  void visit(std::uint32_t cell, const Visit& visit) const {
    const Cell& info = store_.cells()[cell];
    if (places_[cell].empty()) return;
    for (std::uint32_t first = 0; first < info.count; first += kBlockPoints) {
      const Box box = store_.block_box(cell, first / kBlockPoints);
      const double distance = path_.distance(box, places_[cell]);
      if (distance > path_.reach()) continue;
      const double far = std::max(1.0, distance / path_.dense_reach());
      visit(NearBlock{first, std::min(kBlockPoints, info.count - first),
                      surface_of(box) / (far * far)});
    }
  }

  double picked_at(double area) const {
    double sum = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      const auto blocks = static_cast<double>(counts_.bins[bin]);
      sum += blocks * std::min<double>(kBlockPoints, surface_of_bin(bin) / area);
    }
    return sum;
  }

  void pick_cell(std::uint32_t cell, double area, std::vector<PagePoint>& out) const {
    double owed = 0.5;  // fractions of points, carried from block to block
    std::array<PackedChunk<std::int32_t>, 3> chunks;
    bool decoded = false;
    visit(cell, [&](const NearBlock& block) {
      std::uint32_t picked = block.count;
      if (area > 0) {
        owed += std::min<double>(block.count, block.surface / area);
        picked = std::min(block.count, static_cast<std::uint32_t>(owed));
        owed -= picked;
      }
      if (picked == 0) return;
      if (!decoded) chunks = store_.coordinates(cell);
      decoded = true;
      for (std::uint32_t j = 0; j < picked; ++j) {
        const std::uint32_t i = block.first + (2 * j + 1) * block.count / (2 * picked);
        add(position(store_.quantisation(), chunks[0][i], chunks[1][i], chunks[2][i]),
            places_[cell], out);
      }
    });
  }

  void add(const Vec3& xyz, const std::vector<std::uint32_t>& places,
           std::vector<PagePoint>& out) const {
    const double above = 10 * (xyz.z - path_.nearest(xyz, places).top) + 128;
    out.push_back(
        page_point(lattice_, xyz, static_cast<std::uint8_t>(std::clamp(above, 0.0, 255.0))));
  }

  const StoreReader& store_;
  const PathPlaces& path_;
  const PageLattice& lattice_;
  std::vector<std::vector<std::uint32_t>> places_;  ///< of each cell, by find_places()
  Counts counts_;
};

}  // namespace

EnvironmentSample sample_environment(const Store& store, const PathPlaces& path,
                                     const PageLattice& lattice, std::uint64_t most,
                                     Progress& progress) {
  Sampler sampler(store.reader(), path, lattice);
  sampler.count(progress);
  EnvironmentSample out;
  out.near_points = sampler.near_points();
  const double area = out.near_points > most ? sampler.area_for(most) : 0;
  out.spacing = std::sqrt(area);
  out.points = sampler.pick(area, progress);
  sort_along_curve(out.points);
  return out;
}

}  // namespace clearway
