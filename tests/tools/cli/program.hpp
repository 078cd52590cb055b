#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

#include "support/result_fixture.hpp"

namespace clearway::test {

struct Outcome {
  int exit_code;
  std::string out, err;
};

/// Runs a program with `arguments` (shell words), its output into files of `folder`; `pipe`, where
/// given, is a file whose bytes come through a pipe to standard input.
inline Outcome run_program_at(const std::string& program, const ScratchFolder& folder,
                              const std::string& arguments,
                              const std::filesystem::path& pipe = {}) {
  const auto out = folder / "stdout.txt", err = folder / "stderr.txt";
  const std::string before = pipe.empty() ? "" : "cat '" + pipe.string() + "' | ";
  const std::string command = before + "'" + program + "' " + arguments + " >'" + out.string() +
                              "' 2>'" + err.string() + "'";
  const int status = std::system(command.c_str());
  if (status == -1 || !WIFEXITED(status)) throw std::runtime_error("did not exit: " + command);
  return {WEXITSTATUS(status), bytes_of(out), bytes_of(err)};
}

/// The built program clearway.
inline Outcome run_program(const ScratchFolder& folder, const std::string& arguments,
                           const std::filesystem::path& pipe = {}) {
  return run_program_at(CLEARWAY_PROGRAM, folder, arguments, pipe);
}

inline std::string quoted(const std::filesystem::path& path) {
  return std::string("'").append(path.string()).append("'");
}

}  // namespace clearway::test
