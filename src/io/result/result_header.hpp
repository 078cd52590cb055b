#pragma once

#include <string>

#include "io/hdf5/hdf5.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Writes the attributes of a new result except its hashes and `complete`, and the lists of what it
/// ignores.
void write_result_header(const hdf5::Id& file, const ResultHeader& header);

/// Reads the header of a result or of a part. name: the file's, for messages. Throws InputError
/// where the file is not a complete result, or is damaged.
ResultHeader read_result_header(const hdf5::Id& file, const std::string& name);

/// Writes the findings as attributes; findings that are empty have none.
void write_result_findings(const hdf5::Id& file, const ResultFindings& findings);

/// Reads the findings. header: the header of the same file. Throws InputError where an attribute is
/// damaged.
ResultFindings read_result_findings(const hdf5::Id& file, const std::string& name,
                                    const ResultHeader& header);

}  // namespace clearway
