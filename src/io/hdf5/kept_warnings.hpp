#pragma once

#include <string>
#include <vector>

#include "clearway/progress.hpp"
#include "io/hdf5/hdf5.hpp"

namespace clearway {

/// Writes what the run of a part or the conversion of a store warned of into the group "warnings"
/// of their file, as docs/design/result-format.md says.
void write_warnings(const hdf5::Id& file, const std::vector<Message>& warnings);

/// name: of the file. Throws InputError where they are damaged.
std::vector<Message> read_warnings(const hdf5::Id& file, const std::string& name);

}  // namespace clearway
