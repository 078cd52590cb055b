#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

namespace clearway::tool {

bool stop_requested();
/// The flag that stop_requested() reads.
const std::atomic<bool>& stop_flag();

/// Does the work of a command on `output`. SIGINT and SIGTERM ask it to stop (stop_requested());
/// where it then throws Interrupted, the message names the output and gives `advice`. Where it has
/// not ended kGraceSeconds later, the advice goes to standard error and the process ends with exit
/// code 5, as if killed. A second signal ends it at once in the same way. To be called once.
void run_stoppable(const std::filesystem::path& output, const std::string& advice,
                   const std::function<void()>& work);

inline constexpr unsigned kGraceSeconds = 4;

/// The advice of commands that keep nothing of what they began.
inline constexpr const char* kStartsAgain = "the same command starts it again";

}  // namespace clearway::tool
