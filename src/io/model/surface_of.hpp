#pragma once

#include <vector>

#include "clearway/model.hpp"
#include "io/model/model_input.hpp"

namespace clearway {

/// The part of a mesh that is searched: its triangles, cut at options.above, and the vertices that
/// they use, in the order of the file. Throws InputError where nothing is left. Appends notes and
/// warnings, except those of the input.
TriangleMesh kept_surface(const ModelInput& input, const ModelOptions& options,
                          std::vector<Message>& messages);

/// The triangles of a mesh and the vertices that they use, in the order of the file. With
/// options.above they are cut there and what is below is left out. Throws InputError for a file
/// without triangles, and where nothing is left. Appends notes and warnings.
TriangleMesh surface_of(const ModelInput& input, const ModelOptions& options,
                        std::vector<Message>& messages);

}  // namespace clearway
