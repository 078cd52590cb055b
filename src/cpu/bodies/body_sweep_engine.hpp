#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <variant>
#include <vector>

#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"
#include "core/query/body_numbers.hpp"
#include "core/sweep/profile/host_profile.hpp"
#include "cpu/cell_search.hpp"

namespace clearway {

/// Of a body's model and its poses, by what the model consists of.
using BodyFilter = std::variant<const SweepFilterOf<Vec3>*, const SweepFilterOf<Triangle>*,
                                const SweepFilterOf<SolidTriangle>*>;

/// A body as the engine searches it.
struct SweptBody {
  BodyFilter filter;
  std::span<const std::uint32_t> path_pose;  ///< of each of them
  std::uint32_t first_node;  ///< motion nodes of a page are numbered over all bodies, from here on
};

/// The sweep on the CPU of several bodies: searches each page once for each body, and keeps of
/// every point the smallest of the BodyNumbers. What a page says is as of one model.
class BodySweepEngine final : public PageEngine {
 public:
  /// query: with all bodies. All outlive it. Allocates its slots; beside them, at the most
  /// worker_bytes() for each thread that is in `start` at a time, and profile_bytes().
  BodySweepEngine(const PackedCloud& cloud, const Query& query, std::vector<SweptBody> bodies,
                  const SlotLayout& layout);

  std::uint32_t slots() const override { return pool_.layout().slots; }
  std::span<std::byte> page(std::uint32_t slot) override { return pool_.page(slot); }
  void start(std::uint32_t slot, const PageShape& shape) override;
  PageResult finish(std::uint32_t slot) override { return results_[slot]; }

  /// most_poses: of the nodes of any cell, of all bodies together.
  static std::uint64_t worker_bytes(const PackedCloud& cloud, const Query& query,
                                    std::uint64_t most_poses);
  static std::uint64_t profile_bytes(const PackedCloud& cloud, const Query& query,
                                     const SlotLayout& layout, std::uint64_t most_poses);

  /// Of all searches so far. Not during one.
  const SweepStatistics& statistics() const { return statistics_; }

 private:
  using AnyCellSearch =
      std::variant<CellSearchOf<Vec3>, CellSearchOf<Triangle>, CellSearchOf<SolidTriangle>>;
  /// What one thread searches with: a search a body, and the answer of one cell for one body.
  struct Worker {
    std::vector<AnyCellSearch> searches;
    std::vector<std::uint64_t> hits;
    std::vector<std::uint32_t> first_poses;
    std::vector<Clearance> clearances;
  };
  /// Where the nodes of each body begin among those of a cell; one more for their end.
  using NodeRanges = std::vector<std::uint32_t>;

  NodeRanges split_nodes(std::uint32_t slot, const PageShape& shape);
  void select_body(std::uint32_t slot, const PageShape& shape, const NodeRanges& ranges,
                   std::size_t body);
  void search_body(std::uint32_t slot, const PageRef& page, std::size_t body, Worker& worker);
  void merge(std::size_t body, const Worker& worker, std::uint32_t slot, std::uint32_t cell);
  void search_profile(std::uint32_t slot, const PageRef& page, std::size_t body);
  std::unique_ptr<Worker> take_worker();
  void give_back(std::unique_ptr<Worker> worker);

  const PackedCloud& cloud_;
  const Query& query_;
  const BodyNumbers numbers_;
  std::vector<SweptBody> bodies_;
  PagePool pool_;
  std::vector<PageResult> results_;              ///< by slot
  std::vector<ProfileBestValues> bests_;         ///< by body, with a profile
  std::vector<std::vector<ProfileFact>> facts_;  ///< likewise, by slot
  std::mutex mutex_;
  std::vector<std::unique_ptr<Worker>> idle_;  ///< no more than threads were ever in start
  SweepStatistics statistics_;
};

}  // namespace clearway
