#pragma once

#include <vector>

#include "clearway/model.hpp"
#include "io/model/model_input.hpp"

namespace clearway {

/// What is searched of a mesh: its triangles, cut at options.above, and the vertices that they use,
/// in the order of the file. Throws InputError where nothing is left. Notes and warnings are
/// appended, but those of the input.
TriangleMesh kept_surface(const ModelInput& input, const ModelOptions& options,
                          std::vector<Message>& messages);

/// The triangles of a mesh and the vertices that they use, in the order of the file. With
/// options.above they are cut there, and what is below is left out. Throws InputError for a file
/// without triangles, and where none is left. Notes and warnings are appended.
TriangleMesh surface_of(const ModelInput& input, const ModelOptions& options,
                        std::vector<Message>& messages);

}  // namespace clearway
