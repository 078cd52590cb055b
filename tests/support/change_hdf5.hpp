#pragma once

#include <hdf5.h>

#include <filesystem>
#include <string>
#include <vector>

#include "io/files/hdf5.hpp"

/// Changes of a store or a result behind its reader's back, which leave the file sound for HDF5.
namespace clearway::test {

inline hdf5::Id open_to_change(const std::filesystem::path& path) {
  return {H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open"};
}

inline void remove_link(const std::filesystem::path& path, const std::string& name) {
  hdf5::check(H5Ldelete(open_to_change(path).get(), name.c_str(), H5P_DEFAULT), name.c_str());
}

/// write: writes the attribute, which is not there, to the open file that it is called with.
template <typename Write>
void replace_attribute(const std::filesystem::path& path, const char* name, const Write& write) {
  const hdf5::Id file = open_to_change(path);
  hdf5::check(H5Adelete(file.get(), name), name);
  write(file);
}

}  // namespace clearway::test
