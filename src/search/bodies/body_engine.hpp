#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"
#include "core/query/body_numbers.hpp"

namespace clearway {

/// A body's engine, which searches its model at its poses.
struct SearchedBody {
  std::unique_ptr<PageEngine> engine;
  std::span<const std::uint32_t> path_pose;  ///< of each of its poses
  std::uint32_t first_node;  ///< motion nodes of a page are numbered over all bodies, from here on
};

/// The engines of several bodies as one: each page is searched by all of them, and of every point
/// the smallest of the BodyNumbers is kept. On any device.
class BodyEngine final : public PageEngine {
 public:
  /// query: with all bodies; layout: as of each body's engine. What the bodies refer to outlives
  /// it. Allocates answer_bytes().
  BodyEngine(const PackedCloud& cloud, const Query& query, std::vector<SearchedBody> bodies,
             const SlotLayout& layout);

  std::uint32_t slots() const override { return answers_.layout().slots; }
  bool pages_alike() const override { return bodies_.front().engine->pages_alike(); }
  std::span<std::byte> page(std::uint32_t slot) override {
    return bodies_.front().engine->page(slot);
  }
  void start(std::uint32_t slot, const PageShape& shape) override;
  void wait(std::uint32_t slot) override;
  PageResult finish(std::uint32_t slot) override;

  PageEngine& engine(std::size_t body) const { return *bodies_[body].engine; }

  /// Memory for the answers of all slots, beside what the bodies' engines take; most_poses: of the
  /// motion nodes of any cell, of all bodies together.
  static std::uint64_t answer_bytes(const PackedCloud& cloud, const Query& query,
                                    const SlotLayout& layout, std::uint64_t most_poses);

 private:
  void keep_nodes(std::span<std::byte> page, const PageShape& shape, std::size_t body) const;
  void make_room(std::uint32_t slot, std::span<const PageResult> found);
  void merge(std::uint32_t slot, std::size_t body, const PageResult& found);
  template <typename Call>
  void for_all(Call call) const;

  const BodyNumbers numbers_;
  std::vector<SearchedBody> bodies_;
  PagePool answers_;
  std::vector<std::uint32_t> cells_;             ///< of the slot's page
  std::vector<std::vector<ProfileFact>> facts_;  ///< likewise
};

}  // namespace clearway
