#pragma once

#include <cmath>
#include <vector>

#include "clearway/clearway.hpp"
#include "clearway/section.hpp"
#include "support/catch.hpp"
#include "support/result_fixture.hpp"
#include "support/scenes.hpp"

namespace clearway::test {

/// An outline around a place, of corners at random distances in the order of their angles.
inline std::vector<OutlinePoint> random_outline(Random& random, double z, double least,
                                                double most) {
  const std::uint64_t corners = 3 + below(random, 8);
  std::vector<OutlinePoint> outline;
  for (std::uint64_t i = 0; i < corners; ++i) {
    const double angle = (static_cast<double>(i) + uniform(random, 0.1, 0.9)) * 2 * M_PI /
                         static_cast<double>(corners);
    const double radius = uniform(random, least, most);
    outline.push_back({radius * std::cos(angle), z + radius * std::sin(angle)});
  }
  return outline;
}

/// How often each verdict was tested.
struct Verdicts {
  int passes = 0, stopped = 0, unknown = 0;
};

/// Searches for outlines and margins with `run --model-as solid`, and checks what
/// docs/design/section.md guarantees.
class Guarantee {
 public:
  Guarantee(const Store& store, const std::vector<Pose>& path, const Section& section,
            const ScratchFolder& folder)
      : store_(store), path_(path), section_(section), folder_(folder) {}

  void check(const std::vector<OutlinePoint>& outline, double margin, Verdicts& verdicts) const {
    const SectionData& data = section_.data();
    const double eps = data.rounding, most = data.parameters.margin, g = data.parameters.cell;
    const SectionCheck found = section_.check(outline, margin);
    INFO("margin " << margin << ", " << outline.size() << " corners");
    switch (found.verdict) {
      case SectionVerdict::kPasses:
        ++verdicts.passes;
        CHECK_FALSE(first_collision(outline, margin - 2 * eps));
        if (margin + eps <= most) CHECK_FALSE(first_collision(outline, margin));
        break;
      case SectionVerdict::kStopped: {
        ++verdicts.stopped;
        if (data.motion) break;
        const double reach = std::hypot(most, margin + g * std::sqrt(2.0)) + 2 * eps;
        const auto first = first_collision(outline, reach);
        REQUIRE(first);
        CHECK(*first <= found.stop->first_pose);
        break;
      }
      case SectionVerdict::kUnknown:
        ++verdicts.unknown;
    }
  }

  /// The first pose at which a solid with this outline comes closer than the radius to a point.
  std::optional<std::uint32_t> first_collision(const std::vector<OutlinePoint>& outline,
                                               double radius) const {
    QueryParameters parameters{.radius = radius, .first_pose = true};
    const SectionParameters& asked = section_.data().parameters;
    const Query query(outline_model(outline, asked.rear, asked.front), path_, parameters);
    search(store_, query, folder_ / "out.h5",
           {.engine = Engine::kSweep, .device = Device::kCpu, .threads = 2, .overwrite = true});
    const auto poses = Result(folder_ / "out.h5").first_pose();
    if (poses.empty()) return std::nullopt;
    return *std::min_element(poses.begin(), poses.end());
  }

 private:
  const Store& store_;
  const std::vector<Pose>& path_;
  const Section& section_;
  const ScratchFolder& folder_;
};

}  // namespace clearway::test
