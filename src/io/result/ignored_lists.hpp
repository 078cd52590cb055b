#pragma once

#include <string>

#include "io/hdf5/hdf5.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// What a result of version 4 ignores: group /ignored and its attributes.
void write_ignored(const hdf5::Id& file, const ResultHeader& header);

/// Throws InputError where it is damaged, or is none that a run writes. name: of the file.
void read_ignored(const hdf5::Id& file, const std::string& name, ResultHeader& header);

}  // namespace clearway
