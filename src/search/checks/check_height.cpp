#include <algorithm>
#include <vector>

#include "clearway/error.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/facts/ground.hpp"
#include "search/checks/facts/path_cover.hpp"
#include "search/checks/words.hpp"

namespace clearway {
namespace {

constexpr std::size_t kHeightPoses = 32;  ///< poses
// Metres.
constexpr double kLeast = 0.5;
constexpr double kSteady = 0.5;
constexpr double kNarrowest = 1;  ///< a column below a small model holds points of the ground
/// Of the poses that are high up, and of the heights: the others may be beside vegetation or noise.
constexpr double kMostHigh = 0.75;

/// The inner part of a slice of the model, so that walls and kerbs beside it do not count, nor
/// wires that its upper part meets.
Box inner_body(const Box& model, double metre) {
  constexpr double kInner = 0.6;
  Box body = body_slice(model);
  const Vec3 centre = body.centre();
  for (int k = 0; k < 2; ++k) {
    const double half = std::max(kInner * (body.hi[k] - body.lo[k]), kNarrowest * metre) / 2;
    body.lo[k] = centre[k] - half;
    body.hi[k] = centre[k] + half;
  }
  body.hi.z = body.lo.z + (body.hi.z - body.lo.z) / 3;
  return body;
}

/// The heights above ground of the poses, ascending; empty as soon as too few are high up.
std::vector<double> heights_of(const Question& question) {
  const Ground ground(question.cloud);
  const Box body = inner_body(question.model, question.metre);
  const auto poses = spread_poses(question.query.poses.size(), kHeightPoses);
  const auto may_be_low =
      static_cast<std::size_t>((1 - kMostHigh) * static_cast<double>(poses.size()));
  std::vector<double> heights;
  std::size_t low = 0;
  for (const std::uint32_t i : poses) {
    const auto height = ground.height_of(body, question.query.poses[i]);
    if (height && *height >= kLeast * question.metre) {
      heights.push_back(*height);
    } else if (++low > may_be_low) {
      return {};
    }
  }
  std::sort(heights.begin(), heights.end());
  return heights;
}

}  // namespace

bool check_height(const Question& question, MessageLog& log) {
  std::vector<double> heights;
  try {
    heights = heights_of(question);
  } catch (const InputError&) {
    return false;  // a damaged cell is for the search to meet, where it matters
  }
  if (heights.size() < 2) return false;
  const auto at = [&](double share) {
    return heights[static_cast<std::size_t>(share * static_cast<double>(heights.size() - 1))];
  };
  const double usual = at(0.5), spread = at(0.75) - at(0.25);
  if (spread > std::max(kSteady * question.metre, usual / 4)) return false;
  log.warn("floats",
           "along the path the model stays " + length_text(usual, question.unit) +
               " above the highest point below it, and touches no ground. Does it fly or hang? If "
               "not, its heights have another zero: an antenna's, an ellipsoid's, or the model's",
           {{"height", usual}, {"spread", spread}});
  return true;
}

}  // namespace clearway
