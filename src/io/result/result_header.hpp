#pragma once

#include <string>

#include "io/hdf5/hdf5.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// The attributes of a new result but its hashes and `complete`, and what it ignores.
void write_result_header(const hdf5::Id& file, const ResultHeader& header);

/// Throws InputError where the file is not a complete result, or is damaged. name: of the file.
ResultHeader read_result_header(const hdf5::Id& file, const std::string& name);

/// The attributes of what was found beside the tables: none where there is nothing to say.
void write_result_findings(const hdf5::Id& file, const ResultFindings& findings);

/// Throws InputError where they are damaged. header: of the same file.
ResultFindings read_result_findings(const hdf5::Id& file, const std::string& name,
                                    const ResultHeader& header);

}  // namespace clearway
