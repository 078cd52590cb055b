#include "tools/cli/support/program.hpp"

#include <sys/wait.h>

#include <cstdlib>
#include <stdexcept>

namespace clearway::test {

Outcome run_program_at(const std::string& program, const ScratchFolder& folder,
                       const std::string& arguments, const std::filesystem::path& pipe) {
  const auto out = folder / "stdout.txt", err = folder / "stderr.txt";
  // The file is removed, because one that the shell cuts to nothing goes to the disk when it is
  // closed.
  std::filesystem::remove(out);
  std::filesystem::remove(err);
  const std::string before = pipe.empty() ? "" : "cat '" + pipe.string() + "' | ";
  const std::string command = before + "'" + program + "' " + arguments + " >'" + out.string() +
                              "' 2>'" + err.string() + "'";
  const int status = std::system(command.c_str());
  if (status == -1 || !WIFEXITED(status)) throw std::runtime_error("did not exit: " + command);
  return {WEXITSTATUS(status), bytes_of(out), bytes_of(err)};
}

Outcome run_program(const ScratchFolder& folder, const std::string& arguments,
                    const std::filesystem::path& pipe) {
  return run_program_at(CLEARWAY_PROGRAM, folder, arguments, pipe);
}

std::string quoted(const std::filesystem::path& path) {
  return std::string("'").append(path.string()).append("'");
}

}  // namespace clearway::test
