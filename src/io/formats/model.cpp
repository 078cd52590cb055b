#include "io/formats/model.hpp"

#include <cmath>

#include "io/system/input_error.hpp"

namespace clearway {
namespace {

void append(const PointBatch& batch, const CloudInfo& info, std::vector<Vec3>& points) {
  for (const auto& q : batch.quanta) {
    points.push_back(position(*info.quantisation, q[0], q[1], q[2]));
  }
  points.insert(points.end(), batch.positions.begin(), batch.positions.end());
}

}  // namespace

std::vector<Vec3> read_model(const std::filesystem::path& path, CloudInfo* info) {
  const auto reader = open_point_file(path);
  std::vector<Vec3> points;
  PointBatch batch;
  while (reader->read(batch)) {
    std::size_t index = points.size();
    append(batch, reader->info(), points);
    for (; index < points.size(); ++index) {
      const Vec3& p = points[index];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
        refuse(path.string(), "model point " + std::to_string(index) + " (counted from 0) is (" +
                                  shown(p.x) + ", " + shown(p.y) + ", " + shown(p.z) +
                                  "); expected finite coordinates");
      }
    }
  }
  if (info != nullptr) *info = reader->info();
  if (points.empty()) refuse(path.string(), "the model has no points; expected one at least");
  return points;
}

}  // namespace clearway
