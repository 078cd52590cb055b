#pragma once

#include "search/choice/workload.hpp"

namespace clearway {

/// How fine the model field pays for so much work: of ModelFieldOptions, at most 1. spacing: of the
/// model's points, metres. docs/design/sweep.md, "Fineness".
double field_fineness(const Workload& work, double spacing);

}  // namespace clearway
