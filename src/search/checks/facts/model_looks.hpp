#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "clearway/model.hpp"
#include "core/geometry/box.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/geometry/solid_parts.hpp"
#include "search/checks/facts/model_views.hpp"

namespace clearway {

/// What the checks that look at a model from outside see: its own points, samples as close as the
/// radius, or samples farther apart than that.
enum class ModelForm { kPoints, kSurface, kCoarseSurface };

/// Points of a model that stand alone, because no other is within the radius of them. Both numbers
/// are 0 where only a few do.
struct PointsAlone {
  double share = 0;    ///< how many of all points
  double largest = 0;  ///< the largest distance from one of them to the nearest other point
};

/// What the checks of a query know of a model for one radius, whatever its path. Parts that take
/// time are made when they are first asked for. Thread safe.
class ModelLooks {
 public:
  /// Samples a surface as close as the radius, or farther apart where these would be too many.
  /// for_many: whether many questions are to come, for which a tree pays.
  ModelLooks(const Model& model, double radius, bool for_many = false);

  ModelForm form() const { return form_; }
  /// The points that the checks look at: the samples of a surface, or the points of the model.
  const std::vector<Vec3>& points(const Model& model) const {
    return samples_.empty() ? model.vertices : samples_;
  }
  const Box& box() const { return box_; }  ///< box around points()

  // The following take points() of the same model, or that model.

  /// The model as seen along an axis, in cells of twice the radius.
  const ModelView& view(const std::vector<Vec3>& points, int axis) const;
  const SolidParts& solids(const Model& model) const;
  PointsAlone alone(const std::vector<Vec3>& points) const;
  /// How many of these places no model point comes within the radius of.
  std::size_t untouched(const std::vector<Vec3>& points, std::vector<Vec3> places) const;

 private:
  const double radius_;
  const bool for_many_;
  ModelForm form_ = ModelForm::kPoints;
  std::vector<Vec3> samples_;  ///< empty for a model of points
  Box box_{};
  mutable std::array<std::once_flag, 3> view_made_;
  mutable std::array<std::optional<ModelView>, 3> views_;
  mutable std::once_flag solids_made_, alone_made_, tree_made_;
  mutable std::optional<SolidParts> solids_;
  mutable PointsAlone alone_;
  mutable std::optional<ModelTree> tree_;  ///< over the points
};

/// The looks of models that were asked about, the last ones. Thread safe.
class KeptLooks {
 public:
  /// for_many: as for ModelLooks.
  explicit KeptLooks(bool for_many) : for_many_(for_many) {}

  /// hash: hash_of_model().
  std::shared_ptr<const ModelLooks> of(const Model& model, std::uint64_t hash, double radius);

 private:
  struct Kept {
    std::uint64_t hash;
    double radius;
    std::shared_ptr<const ModelLooks> looks;
  };

  const bool for_many_;
  std::mutex mutex_;
  std::list<Kept> kept_;  ///< the most recently used ones first
};

}  // namespace clearway
