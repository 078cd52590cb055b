#pragma once

#include <cstdint>

#include "core/model_tree.hpp"
#include "core/motion_tree.hpp"
#include "core/question.hpp"

namespace clearway {

/// The model on its way from one pose to the next, every point on its straight segment: what of the
/// model's tree comes near a point of the environment. Long steps cost little more than short ones.
class SweptStep {
 public:
  /// `pose` is not the last one. rounding: a bound in metres of every rounding of a test, as
  /// docs/numerics.md ("Between poses") asks for. The arguments outlive it.
  SweptStep(const Question& question, const MotionTree& motion, const ModelTree& model,
            std::uint32_t pose, double rounding);

  /// Whether e collides with a model point at the pose or on the way to the next.
  bool touches(const Vec3& e) const;

  /// False only when no point within rho of `centre` collides on the way or at either of its ends.
  bool may_touch(const Vec3& centre, double rho) const;

 private:
  double half_width(const Box& box) const;
  bool near(const Vec3& e, double rho, const Box& box, double half_width) const;

  const Question& question_;
  const ModelTree& model_;
  const Pose& from_;
  const Pose& to_;
  double stretch_;
  double rounding_;
};

}  // namespace clearway
