#pragma once

#include "io/files/json.hpp"
#include "report/report_facts.hpp"

namespace clearway {

/// What no file can prove and a person can compare on site: the sizes of the bodies and how
/// they stand on the path, their axles, and where the path begins and ends, runs to, and bends
/// most. docs/guide/report.md, "Check these on site".
Json on_site(const ReportFacts& facts);

}  // namespace clearway
