#include "io/store/inspect_points.hpp"

#include <cmath>
#include <span>
#include <vector>

#include "core/geometry/model_tree.hpp"
#include "core/geometry/point_box.hpp"

namespace clearway {
namespace {

/// Most points of a file that may be a model and whose spacing is measured; more would take long.
constexpr std::size_t kModelPoints = 1'000'000;

class Inspection {
 public:
  void add(const PointBatch& batch, const CloudInfo& info) {
    description_.absent += batch.absent.size();
    count_flags(batch.flags);
    for (const auto& q : batch.quanta) add(position(*info.quantisation, q[0], q[1], q[2]));
    for (const Vec3& p : batch.positions) {
      if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) {
        add(p);
      } else {
        ++description_.non_finite;
      }
    }
  }

  PointsDescription finish(const CloudInfo& info) {
    description_.info = info;
    description_.non_finite -= std::min(description_.non_finite, description_.absent);
    if (kept_.size() == description_.points && kept_.size() > 1) {
      description_.spacing = ModelTree(kept_).spacing();
    }
    return std::move(description_);
  }

 private:
  void count_flags(std::span<const std::uint8_t> flags) {
    if (flags.empty()) return;
    if (!description_.flags) description_.flags.emplace();
    FlagCounts& counts = *description_.flags;
    for (const std::uint8_t flag : flags) {
      counts.synthetic += (flag & PointFlags::kSynthetic) != 0 ? 1 : 0;
      counts.key_point += (flag & PointFlags::kKeyPoint) != 0 ? 1 : 0;
      counts.withheld += (flag & PointFlags::kWithheld) != 0 ? 1 : 0;
      counts.overlap += (flag & PointFlags::kOverlap) != 0 ? 1 : 0;
    }
  }

  void add(const Vec3& p) {
    Box& box = description_.box;
    if (description_.points++ == 0) box = {p, p};
    box.extend(p);
    if (kept_.size() < kModelPoints) kept_.push_back(p);
  }

  PointsDescription description_;
  std::vector<Vec3> kept_;
};

}  // namespace

PointsDescription inspect_points(const std::filesystem::path& path) {
  const auto reader = open_point_file(path);
  Inspection inspection;
  PointBatch batch;
  while (reader->read(batch)) inspection.add(batch, reader->info());
  return inspection.finish(reader->info());
}

}  // namespace clearway
