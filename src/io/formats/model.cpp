#include "clearway/model.hpp"

#include <cmath>

#include "core/util/format.hpp"
#include "io/formats/point_reader.hpp"
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

std::vector<Vec3> read_model(const std::filesystem::path& path, std::vector<Message>* warnings) {
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
  if (points.empty()) refuse(path.string(), "the model has no points; expected one at least");
  const std::uint64_t faces = reader->info().faces;
  if (faces > 0 && warnings != nullptr) {
    warnings->push_back({Message::Severity::kWarning, "mesh-faces",
                         path.string() + ": its " + format_count(faces) +
                             " faces are not read: the model is its " +
                             format_count(points.size()) +
                             " points; sample the surface where they are farther apart than the "
                             "radius"});
  }
  return points;
}

}  // namespace clearway
