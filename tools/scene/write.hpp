#pragma once

#include "core/util/progress.hpp"
#include "io/files/file.hpp"
#include "scene/scene.hpp"

namespace clearway::scene {

/// Writes the environment as LAS in the order of scanning, front to back, with `threads` threads
/// (0: all) and memory that does not depend on the number of points. Throws ResourceError.
void write_environment(const Scene& scene, std::uint64_t seed, const File& file, int threads,
                       Progress& progress);

/// Writes the places of the scanner as CSV with the header first,x,y,z: from point `first` on, it
/// stood at x, y, z. These are the starts of the rays. A ray is straight along the path, so where
/// the path bends it is a curve in space.
void write_origins(const Scene& scene, const File& file);

/// Writes the model as binary PLY, float32.
void write_model(const Scene& scene, const File& file);

/// Writes the trajectory with twelve numbers a line, nine digits each: rotation and translation,
/// row-major 3 x 4.
void write_trajectory(const Scene& scene, const File& file);

}  // namespace clearway::scene
