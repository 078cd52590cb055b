#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "clearway/clearway.hpp"
#include "clearway/section.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"
#include "support/scenes.hpp"
#include "support/store_fixture.hpp"

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

/// Checks that every question about loads of these ranges, margins and windows causes no warning.
inline void check_sound(const std::filesystem::path& store, const std::vector<Pose>& path,
                        const std::vector<std::array<double, 2>>& ranges,
                        const std::vector<double>& margins,
                        const std::vector<std::optional<SectionWindow>>& windows) {
  const ScratchFolder folder;
  for (const auto& [rear, front] : ranges) {
    for (const double margin : margins) {
      for (const auto& window : windows) {
        INFO("from " << rear << " to " << front << ", margin " << margin);
        const SectionReport report = find_section(
            Store(store), path,
            {.rear = rear, .front = front, .window = window, .cell = 0.05, .margin = margin},
            folder / "section.h5", {.threads = 2, .overwrite = true});
        check_equal(codes_of(report.warnings), "");
      }
    }
  }
}

/// How often each verdict was tested.
struct Verdicts {
  int passes = 0, stopped = 0, unknown = 0;
};

/// Searches for outlines and margins with `run --model-as solid`, and checks what
/// docs/design/section.md guarantees.
class Guarantee {
 public:
  Guarantee(const std::filesystem::path& store, const std::vector<Pose>& path,
            const Section& section, const ScratchFolder& folder)
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
  Store store_;
  const std::vector<Pose>& path_;
  const Section& section_;
  const ScratchFolder& folder_;
};

/// A tube of points around a path that bends, with a few points inside it.
struct Tube {
  explicit Tube(std::uint64_t seed, int poses = 40, double step = 0.4) {
    Random random(seed);
    for (int i = 0; i < poses; ++i) {
      const double angle = 0.01 * i, radius = step / 0.01;
      path.push_back(rotation({0, 0, 1}, angle,
                              {radius * std::sin(angle), radius * (1 - std::cos(angle)), 0.5}));
    }
    for (int i = 0; i < 6000; ++i) {
      const Pose& pose = path[below(random, path.size())];
      const double around = uniform(random, 0, 2 * M_PI);
      const double radius = below(random, 400) == 0 ? uniform(random, 0.8, 2) : 2.2;
      points.push_back(pose.rotated({uniform(random, -2, 2), radius * std::cos(around),
                                     2 + radius * std::sin(around)}) +
                       pose.position());
    }
    for (int i = 0; i < 200; ++i) points.push_back(points[static_cast<std::size_t>(i)]);
    write_ply(folder / "tube.ply", points);
    convert({folder / "tube.ply"}, folder / "tube.h5", {.cell_points = 512, .threads = 2});
    asked = {.rear = -1.5,
             .front = 2,
             .window = SectionWindow{-3, 3, -0.5, 4.5},
             .cell = 0.05,
             .bin = 3,
             .margin = 0.3};
  }

  SectionReport find(const SectionOptions& options = {.threads = 2, .overwrite = true}) const {
    return find_section(Store(folder / "tube.h5"), path, asked, folder / "section.h5", options);
  }

  Section section() const { return Section(folder / "section.h5"); }
  std::string bytes() const { return bytes_of(folder / "section.h5"); }
  Guarantee guarantee(const Section& of, const std::vector<Pose>& poses) const {
    return {folder / "tube.h5", poses, of, folder};
  }

  ScratchFolder folder;
  std::vector<Vec3> points;  ///< the first 200 are there twice
  std::vector<Pose> path;
  SectionParameters asked;
};

}  // namespace clearway::test
