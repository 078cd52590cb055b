#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/pose.hpp"
#include "clearway/result.hpp"
#include "clearway/vec3.hpp"
#include "io/result/result_header.hpp"

namespace clearway {

/// Says which colliding points of a result, a, another one, b, would have found too if they were
/// still there. It goes by what the results say of their questions and by the warnings of b, and
/// reads neither the environment nor the model. Where it is not certain that b would have found a
/// point, b has not searched its place.
class SearchedPlaces {
 public:
  /// The results and poses must outlive this object.
  SearchedPlaces(const Result& a, const std::vector<Pose>& poses_a, const Result& b,
                 const std::vector<Pose>& poses_b);

  /// Adds the reasons why b has not searched the place of a point of a, none where it has: "radius"
  /// where that of b is smaller, "model", "motion" or "path" where these are others than in a,
  /// "floor" where that of b is higher or, for another vehicle, may be, "ignored" where b left out
  /// points there, "withheld" where the scans of b have more points that were left out as deleted,
  /// and the code of each warning of b that says so. If both are about the same scan, the point is
  /// known to be there still, and another vehicle or path that does not touch it has freed it, so
  /// that these are no reasons. first, last: the first and the last pose at which the point
  /// collides in a.
  void add_reasons(const Vec3& place, std::uint32_t first, std::uint32_t last,
                   std::set<std::string>& reasons) const;

 private:
  struct DoubtfulStretch {
    std::string code;
    PoseRange poses;  ///< of b
  };

  void compare_questions(const std::vector<Pose>& poses_a, const std::vector<Pose>& poses_b);
  void compare_ignored(const ResultFindings& findings);  ///< of b
  void take_warnings(const Answer& a, const Answer& b);
  /// Adds where b may have missed points, as one of its warnings says, and a has not.
  void add_fault(const Answer& a, const Message& warning);
  void add_stretches(const std::string& code, const std::vector<PoseRange>& stretches);
  std::optional<std::uint32_t> pose_of_b(std::uint32_t pose) const;

  const ResultHeader &a_, &b_;
  const bool same_scan_;
  std::set<std::string> everywhere_;  ///< reasons that hold at every place
  /// The pose of b that equals each pose of a; kNone where b has none. Empty where the paths are
  /// the same.
  std::vector<std::uint32_t> pose_of_b_;
  std::vector<DoubtfulStretch> stretches_;
};

}  // namespace clearway
