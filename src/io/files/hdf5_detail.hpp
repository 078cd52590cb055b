#pragma once

#include <cstdint>
#include <string>

#include "io/files/hdf5.hpp"

/// Functions that the implementations of hdf5.hpp share.
namespace clearway::hdf5 {

/// HDF5's innermost reason for its last failure.
std::string reason();

/// Throws CallFailure "`what`: reason", a Failure unless a system call failed.
[[noreturn]] void fail(const std::string& what);

/// Throws ResourceError where HDF5's last failure was that of a system call, otherwise InputError
/// about a dataset or attribute of a file.
[[noreturn]] void malformed(const std::string& file, const std::string& name,
                            const std::string& expected);

Id property_list(hid_t kind);
/// A property list of this kind for objects that store no times.
Id untimed(hid_t kind);

/// A data space of rows x columns; columns 0 makes it one-dimensional.
Id simple_space(std::uint64_t rows, std::uint64_t columns);

}  // namespace clearway::hdf5
