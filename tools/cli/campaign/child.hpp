#pragma once

#include <signal.h>
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace clearway::tool {

/// A command of this program that is to run in a process of its own.
struct ChildCommand {
  std::vector<std::string> words;  ///< the command line, without the program's name
  std::filesystem::path folder;    ///< the folder that the command works in
  std::filesystem::path log;       ///< appended to: standard error, and output if `output` is empty
  std::filesystem::path output;    ///< replaced by standard output; empty: that goes to the log
  std::vector<int> foreign;        ///< the caller's descriptors that the child closes
  sigset_t signals{};              ///< the signal mask of the child
};

/// Forks a child that calls the program's entry, without loading the program again, and returns its
/// process id. The calling process must have one thread. The child is killed when the caller dies,
/// and has a process group of its own, so that signals of the terminal reach the caller alone.
/// Throws ResourceError.
pid_t start_child(const ChildCommand& command);

}  // namespace clearway::tool
