#include "scene/vehicles/models.hpp"

namespace clearway::scene {
namespace {

/// Adds the bucket, which slopes down towards the cutting edge and is open to the front.
void add_bucket(Mesh& mesh) {
  const double back = 3.1, edge = 4.8, half = 1.3;
  mesh.add_quad({back, -half, 0.45}, {edge, -half, 0.2}, {edge, half, 0.2}, {back, half, 0.45});
  mesh.add_quad({back, -half, 0.45}, {back, half, 0.45}, {back - 0.15, half, 1.5},
                {back - 0.15, -half, 1.5});
  mesh.add_quad({back - 0.15, -half, 1.5}, {back - 0.15, half, 1.5}, {back + 0.35, half, 1.75},
                {back + 0.35, -half, 1.75});
  for (const double y : {-half, half}) {
    mesh.add_quad({back, y, 0.45}, {edge, y, 0.2}, {edge - 0.5, y, 0.9}, {back + 0.3, y, 1.7});
  }
  for (int tooth = -4; tooth <= 4; ++tooth) {
    const double y = 0.3 * tooth;
    mesh.add_box({edge, y - 0.05, 0.17}, {edge + 0.15, y + 0.05, 0.24});
  }
}

void add_frame_and_cab(Mesh& mesh) {
  mesh.add_box({-4.65, -1.15, 0.75}, {-1.0, 1.15, 1.65});  // engine
  mesh.add_box({-4.4, -0.85, 1.65}, {-1.4, 0.85, 1.85});   // its hood
  mesh.add_box({-4.65, -0.6, 0.4}, {-0.9, 0.6, 0.75});     // rear frame
  mesh.add_box({-0.9, -0.25, 0.5}, {0.4, 0.25, 1.2});      // joint
  mesh.add_box({0.3, -0.75, 0.45}, {2.6, 0.75, 1.3});      // front frame
  mesh.add_box({-1.3, 0.3, 1.1}, {0.0, 1.25, 2.2});        // cab
  mesh.add_box({-1.35, 0.25, 2.2}, {0.05, 1.3, 2.28});     // its roof
  for (const double side : {-1.0, 1.0}) {
    mesh.add_box({-4.1, side * 1.0 - 0.2, 1.45}, {-2.2, side * 1.0 + 0.2, 1.6});  // mudguards
    mesh.add_box({0.9, side * 0.45 - 0.1, 1.2}, {2.9, side * 0.45 + 0.1, 1.55});  // boom
  }
}

}  // namespace

Mesh front_loader() {
  Mesh mesh;
  for (const double x : {-3.0, 1.7}) {
    for (const double y : {-0.92, 0.92}) mesh.add_wheel({x, y, 0.82}, 0.82, 0.62);
    mesh.add_box({x - 0.2, -0.6, 0.55}, {x + 0.2, 0.6, 1.0});
  }
  add_frame_and_cab(mesh);
  add_bucket(mesh);
  return mesh;
}

}  // namespace clearway::scene
