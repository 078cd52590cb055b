#pragma once

#include <string>

namespace clearway::tool {

/// From here on SIGINT and SIGTERM ask the command to stop (stop_requested()). Where it has not
/// come to an end kGraceSeconds later, `advice` goes to standard error and the process ends with
/// exit code 5, as if killed. A second signal ends it so at once. To be called once.
void stop_on_signals(const std::string& advice);

bool stop_requested();

inline constexpr unsigned kGraceSeconds = 4;

}  // namespace clearway::tool
