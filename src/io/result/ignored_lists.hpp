#pragma once

#include <string>

#include "io/hdf5/hdf5.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Writes what a result of version 4 ignores: the group /ignored and its attributes.
void write_ignored(const hdf5::Id& file, const ResultHeader& header);

/// Reads the group /ignored and its attributes into `header`. name: the file's, for messages.
/// Throws InputError where the group is damaged or has contents that no run writes.
void read_ignored(const hdf5::Id& file, const std::string& name, ResultHeader& header);

}  // namespace clearway
