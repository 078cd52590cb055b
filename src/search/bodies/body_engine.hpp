#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"
#include "core/query/body_numbers.hpp"

namespace clearway {

/// The engine that searches the model of one body at the poses of that body.
struct SearchedBody {
  std::unique_ptr<PageEngine> engine;
  /// For each pose of the body, the index of the pose of the path that it belongs to.
  std::span<const std::uint32_t> path_pose;
  /// The number of the body's first motion node in a page, where nodes are numbered over all
  /// bodies.
  std::uint32_t first_node;
};

/// The engines of several bodies as one engine, on any device. Every page is searched by all of
/// them, and for each point the smallest of the BodyNumbers is kept.
class BodyEngine final : public PageEngine {
 public:
  /// query: the query with all bodies. layout: the one that each body's engine has. What the bodies
  /// refer to outlives this engine. Allocates answer_bytes().
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

  /// Bytes of memory for the answers of all slots, beside what the bodies' engines take.
  /// most_poses: the most poses of the motion nodes of any cell, for all bodies together.
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
  /// For each slot, the number of cells of its page.
  std::vector<std::uint32_t> cells_;
  /// For each slot, the profile facts of its page.
  std::vector<std::vector<ProfileFact>> facts_;
};

}  // namespace clearway
