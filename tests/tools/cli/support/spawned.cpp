#include "tools/cli/support/spawned.hpp"

#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

namespace clearway::test {

std::uint64_t peak_memory_of(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), CLEARWAY_PROGRAM);
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  pid_t child = 0;
  if (::posix_spawn(&child, words[0], nullptr, nullptr, words.data(), environ) != 0) {
    throw std::runtime_error("cannot start the program");
  }
  int status = 0;
  struct rusage usage {};
  if (::wait4(child, &status, 0, &usage) != child || status != 0) {
    throw std::runtime_error("the program failed");
  }
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace clearway::test
