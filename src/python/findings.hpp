#pragma once

#include <cstdint>
#include <string>

#include "clearway/conflicts.hpp"
#include "python/python.hpp"

namespace clearway::python {

/// The options that find_conflicts() and write_report() have in common.
ConflictOptions conflict_options(double gap, std::uint64_t min_points, double split,
                                 double chainage_start, const std::string& forward,
                                 const std::string& up, std::uint64_t memory_bytes, int threads);

/// The conflicts as a Python object, which lacks the conflict of each row.
py::object to_python(Conflicts conflicts);

}  // namespace clearway::python
