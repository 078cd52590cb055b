#pragma once

#include <string>
#include <vector>

#include "clearway/progress.hpp"
#include "io/files/hdf5.hpp"

namespace clearway {

/// Writes the warnings of a search, a section or the conversion of a store into the group
/// "warnings" of its file (docs/design/result-format.md).
void write_warnings(const hdf5::Id& file, const std::vector<Message>& warnings);

/// Reads the warnings. name: the file's, for messages. Throws InputError where they are damaged.
std::vector<Message> read_warnings(const hdf5::Id& file, const std::string& name);

}  // namespace clearway
