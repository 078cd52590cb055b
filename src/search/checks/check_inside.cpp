#include <algorithm>
#include <vector>

#include "clearway/error.hpp"
#include "core/geometry/point_box.hpp"
#include "core/geometry/solid_parts.hpp"
#include "core/util/format.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/facts/drive.hpp"
#include "search/checks/facts/model_views.hpp"
#include "search/checks/facts/path_cover.hpp"
#include "search/checks/facts/scan_points.hpp"
#include "search/checks/words.hpp"

namespace clearway {
namespace {

/// At most this many points are looked at.
constexpr std::size_t kMostInside = 65'536;
/// Fewer points than this may be noise.
constexpr std::size_t kFewInside = 10;
constexpr std::size_t kMeasuredInside = 64;
/// The least open share of the model's outline, seen along the direction of motion, that is warned
/// of.
constexpr double kOpen = 0.4;

/// The scan's points in the model's box at the first pose, in the model's frame, except those in
/// the model's solids, which collide.
std::vector<Vec3> points_in_box(const Question& question, const Query& asked) {
  std::vector<Vec3> inside;
  try {
    ScanPoints(question.cloud)
        .visit(question.model, question.query.poses.front(), [&](const Vec3& p) {
          inside.push_back(p);
          return inside.size() < kMostInside;
        });
  } catch (const InputError&) {
    inside.clear();  // a damaged cell is reported by the search, where it matters
  }
  if (asked.model.is_solid() && !inside.empty()) {
    const SolidParts solids(asked.model);
    std::erase_if(inside, [&](const Vec3& p) { return solids.ref().contains(p); });
  }
  return inside;
}

/// Keeps the points that have model points in all six directions.
void keep_enclosed(const Question& question, double distance, std::vector<Vec3>& points) {
  for (int axis = 0; axis < 3 && points.size() >= kFewInside; ++axis) {
    const ModelView view(question.query.model.vertices, question.model, axis, 2 * distance);
    std::erase_if(points, [&](const Vec3& p) { return !view.encloses(p, distance); });
  }
}

/// An estimate, from some of the points, of how many of them no model point comes within the radius
/// of.
std::uint64_t untouched(const Question& question, const std::vector<Vec3>& points) {
  std::vector<Vec3> some;
  for (const std::uint32_t i : spread_poses(points.size(), kMeasuredInside)) {
    some.push_back(points[i]);
  }
  const std::size_t measured = some.size();
  for (const Vec3& m : question.query.model.vertices) {
    std::erase_if(some, [&](const Vec3& p) { return collides(m, p, question.query.radius); });
    if (some.empty()) break;
  }
  return points.size() * some.size() / measured;
}

/// The axis of the model along which it moves; the model's longest one where that cannot be told.
int axis_of_motion(const Question& question) {
  const Drive drive(question);
  if (!drive.is_one()) return question.model.longest_axis();
  const Vec3 shares = drive.along_axes();
  return shares.x >= shares.y && shares.x >= shares.z ? 0 : shares.y >= shares.z ? 1 : 2;
}

}  // namespace

void check_inside(const Question& question, const Query& asked, MessageLog& log) {
  const std::vector<Vec3> in_box = points_in_box(question, asked);
  std::vector<Vec3> enclosed = in_box;
  keep_enclosed(question, question.query.radius, enclosed);
  if (enclosed.size() < kFewInside) return;
  const std::uint64_t count = untouched(question, enclosed);
  // A rough ground that reaches into the model also touches it, and so is in the result.
  if (count < kFewInside || count < in_box.size() - untouched(question, in_box)) return;
  log.warn("inside-model",
           "at pose " + std::to_string(question.number_of(0)) + " about " + format_count(count) +
               " scanned points lie inside the model and do not touch it: only its surface is "
               "tested. Does it stand on an obstacle there? Let the path begin outside of it, "
               "search a closed mesh as a solid, or give a model that is filled with points",
           {{"points", static_cast<double>(count)}});
}

void check_open_model(const Question& question, MessageLog& log) {
  if (Sides(question.model).middle == 0) return;
  const int axis = axis_of_motion(question);
  const ModelView view(question.query.model.vertices, question.model, axis,
                       2 * question.query.radius);
  const double share = view.open_share();
  if (share < kOpen) return;
  log.warn("open-model",
           "seen along its " + std::string(1, "xyz"[axis]) +
               " axis the model is open: no point in " + share_text(share) +
               " of its outline. What passes through there is not found. Does the model consist of "
               "lines, or lack its front and rear?",
           {{"share", share}});
}

}  // namespace clearway
