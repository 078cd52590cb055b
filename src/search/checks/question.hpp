#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "clearway/query.hpp"
#include "clearway/section.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/box.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/trajectory/chainage.hpp"
#include "io/scans/point_reader.hpp"
#include "search/checks/facts/model_looks.hpp"

namespace clearway {

/// How messages call what a question is about.
struct QuestionWords {
  const char* mover;     ///< what moves
  const char* distance;  ///< the distance that it keeps
  const char* nothing;   ///< what follows where there are no points or poses
};
inline constexpr QuestionWords kWordsOfModel{"model", "radius", "nothing can collide"};
inline constexpr QuestionWords kWordsOfLoad{"load", "margin", "nothing blocks a load"};

/// The box that the checks assume for the load of a section, whose outline is not known yet, in the
/// frame of the load: it stands on z = 0 in the middle of the lane, and is longer than it is wide.
/// metre: the length of a metre. The defaults of `asked` are filled in.
Box assumed_load(const SectionParameters& asked, double metre);

/// A length with its unit, for example "12.3 m".
std::string length_text(double length, LengthUnit unit);

/// The side lengths of a box with their unit, for example "4.5 x 1.9 x 1.5 m".
std::string size_text(const Box& box, LengthUnit unit);

/// The query, the environment and derived sizes that the checks of a query look at. Owns nothing.
struct Question {
  /// The environment and the model have at least one point, and the trajectory at least one pose.
  /// looks: those of the query's model and radius. For a body, path_pose is the one of Body, and
  /// path_chainage the chainage of all poses of the path that it follows. For the load of a
  /// section, the model has the corners of assumed_load(), and the radius is the margin.
  Question(const PackedCloud& environment, LengthUnit length_unit, const Query& asked,
           const ModelLooks& looks, std::span<const std::uint32_t> path_pose = {},
           std::span<const double> path_chainage = {}, const SectionParameters* section = nullptr);

  /// The number by which users know a pose.
  std::uint32_t number_of(std::uint32_t pose) const {
    return path_pose.empty() ? pose : path_pose[pose];
  }
  /// Metres along the positions of the path up to the pose that users know as number_of(pose).
  double chainage(std::uint32_t pose) const;

  bool is_load() const { return section != nullptr; }
  const QuestionWords& words() const { return is_load() ? kWordsOfLoad : kWordsOfModel; }
  std::string mover() const { return words().mover; }
  /// A length, and the size of the model, in sentences.
  std::string length(double metres) const { return length_text(metres, unit); }
  std::string size() const { return size_text(model, unit); }
  /// The least z, in its own frame, at which the load may begin: the window of a section may reach
  /// below the wheels, on which z is 0.
  double lowest_of_load() const { return std::min(0.0, section->window->z_from); }

  const PackedCloud& cloud;
  LengthUnit unit;
  const Query& query;
  const ModelLooks& looks;
  /// The points that the checks look at: ModelLooks::points().
  const std::vector<Vec3>& points;
  std::span<const std::uint32_t> path_pose;
  /// Chainage of the path's poses for a body; empty otherwise, since it then follows from the
  /// poses.
  std::span<const double> path_chainage;
  const SectionParameters* section;  ///< null for a model
  /// The box around all points.
  Box environment;
  /// The box of `points`, in the model's own frame.
  Box model;
  /// The longest side of the model; for a body, that of the whole vehicle.
  double longest;
  /// The length of a metre in the environment's unit.
  double metre;
  /// StoreMetadata::steps of the environment
  std::array<double, 3> steps{};
};

/// The lengths of a box's sides, the longest first.
struct Sides {
  explicit Sides(const Box& box);
  double longest, middle, shortest;
};

/// The factor by which a pose stretches lengths, on average over the axes; 1 for a rigid one.
double scale_of(const Pose& pose);

// How the warnings write lengths and boxes.

/// The symbol of a unit of length: "m" or "ft".
std::string unit_name(LengthUnit unit);

/// The range of a box on each axis, for example "x -65.7 to 140, y -79.8 to 92.6, z -16.3 to 5.18".
std::string extent_text(const Box& box);

/// A share in percent, for example "12 %"; "below 1 %" and "above 99 %" where the rounded figure
/// would say none or all.
std::string share_text(double share);

}  // namespace clearway
