#pragma once

#include <filesystem>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// Reads a model point cloud (any format of point_reader.hpp) into memory; a stored integer's
/// position is q * scale + offset. Throws InputError for malformed files, for a model without
/// points and for non-finite coordinates (naming the point's index). info: where given, becomes
/// what the file says of its points.
std::vector<Vec3> read_model(const std::filesystem::path& path, CloudInfo* info = nullptr);

}  // namespace clearway
