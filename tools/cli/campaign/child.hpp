#pragma once

#include <signal.h>
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace clearway::tool {

/// A command of this program, in a process of its own.
struct ChildCommand {
  std::vector<std::string> words;  ///< without the program's name
  std::filesystem::path folder;    ///< that it works in
  std::filesystem::path log;       ///< appended to: what it prints and tells
  std::filesystem::path output;    ///< standard output instead, replaced; empty: to the log
  std::vector<int> foreign;        ///< descriptors that are not for it
  sigset_t signals{};              ///< blocked signals, as they were
};

/// Forks; the child calls the program's entry, without loading the program again. The calling
/// process has one thread. Where that dies, the child is killed. Signals of the terminal reach the
/// caller alone. Throws ResourceError.
pid_t start_child(const ChildCommand& command);

}  // namespace clearway::tool
