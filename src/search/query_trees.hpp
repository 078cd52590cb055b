#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "clearway/query.hpp"
#include "core/trajectory/motion_tree.hpp"
#include "core/util/stopwatch.hpp"
#include "search/kept_models.hpp"

namespace clearway {

/// make() for the Element that a model consists of: Vec3, Triangle or SolidTriangle.
template <typename Make>
auto for_element_of(const Model& model, const Make& make) {
  if (model.is_solid()) return make.template operator()<SolidTriangle>();
  if (model.is_surface()) return make.template operator()<Triangle>();
  return make.template operator()<Vec3>();
}

/// The trees over a model's points or triangles and over the poses, with which every plan of a
/// query starts.
struct QueryTrees {
  /// The query outlives the trees. kept: the models whose trees are made already; null: the trees
  /// are made. hash: that of the model, where it is known. clock: started just before, for
  /// model_seconds.
  explicit QueryTrees(const Query& query, int threads = 1, KeptModels* kept = nullptr,
                      std::optional<std::uint64_t> hash = {}, const Stopwatch& clock = {})
      : model(kept != nullptr ? kept->index_of(query.model, hash, threads)
                              : std::make_shared<ModelIndex>(query.model, threads, 1)),
        of_session(kept != nullptr && kept->is_session()),
        model_seconds(clock.seconds()),
        motion(query.poses, box(), query.between_poses, threads_for_poses(query, threads)),
        motion_seconds(clock.seconds() - model_seconds) {}

  /// The threads that pay for the poses of a query: with few poses, to wake a thread would take
  /// longer than the work.
  static int threads_for_poses(const Query& query, int threads) {
    constexpr std::size_t kPosesOfThread = 256;
    return static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(threads),
                                                  1 + query.poses.size() / kPosesOfThread));
  }

  /// The bytes of the trees, without what the model's index has besides them.
  std::uint64_t allocated_bytes() const {
    return model->points.allocated_bytes() + model->triangles.allocated_bytes() +
           model->solids.allocated_bytes() + motion.allocated_bytes();
  }

  /// The model's box. The model is not empty.
  const Box& box() const { return model->box(); }

  /// The tree over the model's elements.
  template <typename Element>
  const ModelTreeOf<StoredElement<Element>>& of() const {
    return model->of<Element>();
  }

  std::shared_ptr<ModelIndex> model;
  bool of_session;       ///< whether the model's index is kept for questions to come
  double model_seconds;  ///< wall clock of the model's trees
  MotionTree motion;
  double motion_seconds;
};

}  // namespace clearway
