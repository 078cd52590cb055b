#include <algorithm>

#include "search/checks/checks.hpp"
#include "search/checks/facts/scan_proximity.hpp"
#include "search/checks/words.hpp"

namespace clearway {
namespace {

constexpr double kLargestRadius = 10;  ///< metres
/// The least number of steps of the stored coordinates in a radius.
constexpr double kSteps = 10;
/// Diagonal of a block of 64 points of a surface in units of the scan's spacing: such a block is 8
/// spacings wide and 8 spacings high.
constexpr double kSpacingsOfBlock = 11.3;

void warn_of_large_radius(const Question& question, MessageLog& log) {
  const double radius = question.query.radius, longest = Sides(question.model).longest;
  const bool above_model = longest > 0 && radius > longest;
  if (!above_model && radius <= kLargestRadius * question.metre) return;
  log.warn("radius-size",
           "the radius is " + length_text(radius, question.unit) + ", the model's longest side " +
               length_text(longest, question.unit) +
               ". Is the radius meant in another unit, such as millimetres?",
           {{"radius", radius}, {"model_longest", longest}});
}

void warn_of_fine_radius(const Question& question, MessageLog& log) {
  const double* scale = question.cloud.quantisation().scale;
  const double step = *std::max_element(scale, scale + 3);
  const double radius = question.query.radius;
  // A radius of ten steps as typed is not warned of because of its rounding.
  if (radius >= kSteps * step * (1 - 1e-9)) return;
  log.warn("fine-radius",
           "the radius is " + length_text(radius, question.unit) +
               ", the scan's coordinates are in steps of " + length_text(step, question.unit) +
               ": rounding decides which points collide. Check the radius' unit, or store the "
               "scan in finer steps",
           {{"radius", radius}, {"step", step}});
}

/// Warns of a scan whose points are far apart, because it says nothing about what lies between
/// them. A radius bridges gaps in walls and ground, but not those in which a post stands.
void check_coarse_scan(const Question& question, MessageLog& log) {
  const ScanProximity scan(question.cloud, 0);
  const double spacing = scan.typical_block() / kSpacingsOfBlock;
  const double radius = question.query.radius, metre = question.metre;
  const double width = Sides(question.model).middle;
  // The following lengths are in metres.
  constexpr double kTold = 0.1, kWide = 0.3, kVeryWide = 0.5;
  const bool is_wide = spacing > 5 * radius && spacing > std::min(width / 5, kWide * metre);
  const bool is_very_wide = spacing > 2 * radius && spacing > kVeryWide * metre;
  if (!is_wide && !is_very_wide) {
    if (spacing > 2 * radius && spacing > kTold * metre) {
      log.note("the scan's points are typically " + length_text(spacing, question.unit) +
               " apart: what is narrower can stand between them, where the scan does not show it");
    }
    return;
  }
  log.warn("coarse-scan",
           "the scan's points are typically " + length_text(spacing, question.unit) +
               " apart. The radius is " + length_text(question.query.radius, question.unit) +
               " and the model " + length_text(width, question.unit) +
               " wide: it can pass between the points of what stands in its way. Take a denser "
               "scan or a larger radius, and check that scan and model have one unit",
           {{"scan_spacing", spacing}, {"radius", radius}, {"model_width", width}});
}

}  // namespace

void check_radius(const Question& question, MessageLog& log) {
  warn_of_large_radius(question, log);
  warn_of_fine_radius(question, log);
  if (question.cloud.point_count() >= kBlockPoints) check_coarse_scan(question, log);
}

}  // namespace clearway
