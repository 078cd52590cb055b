// The progress line on a terminal, which must not wrap.
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <string>

#include "support/catch.hpp"
#include "support/result_fixture.hpp"

using namespace clearway::test;

namespace {

/// What the program writes to a terminal with this number of columns.
std::string output_on_terminal(unsigned short columns, const std::string& arguments) {
  winsize size{};
  size.ws_col = columns;
  size.ws_row = 24;
  int terminal = -1;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    const std::string command = std::string("exec '") + CLEARWAY_PROGRAM + "' " + arguments;
    ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    ::_exit(127);
  }
  REQUIRE(child > 0);
  std::string text;
  char buffer[4096];
  for (ssize_t got = 0; (got = ::read(terminal, buffer, sizeof buffer)) > 0;) {
    text.append(buffer, static_cast<std::size_t>(got));
  }
  ::close(terminal);
  int status = 0;
  ::waitpid(child, &status, 0);
  REQUIRE(WEXITSTATUS(status) == 0);
  return text;
}

/// The progress lines, each of which stands between a carriage return and the clearing of the rest
/// of the line.
std::vector<std::string> progress_lines(const std::string& text) {
  const std::string clear = "\033[K";
  std::vector<std::string> lines;
  for (std::size_t end = text.find(clear); end != std::string::npos;
       end = text.find(clear, end + 1)) {
    const std::size_t begin = text.rfind('\r', end);
    if (begin != std::string::npos && end > begin + 1) {
      lines.push_back(text.substr(begin + 1, end - begin - 1));
    }
  }
  return lines;
}

}  // namespace

TEST_CASE("the progress line fits the terminal") {
  const ScratchFolder folder;
  const auto longest = [&](unsigned short columns) {
    std::vector<std::string> lines;
    // Slow machines draw often, but fast ones do not draw at all where there is too little to do.
    for (int points = 2; lines.empty() && points <= 32; points *= 4) {
      lines = progress_lines(output_on_terminal(
          columns, "scene hall --force --threads 1 --model-points 100 --poses 10 --points " +
                       std::to_string(points) + "000000 -o '" + (folder / "").string() + "'"));
    }
    REQUIRE_FALSE(lines.empty());
    std::size_t most = 0;
    for (const std::string& line : lines) {
      CHECK(line.find(" %") != std::string::npos);
      most = std::max(most, line.size());
    }
    return most;
  };
  CHECK(longest(200) > 40);
  CHECK(longest(40) < 40);
  CHECK(longest(12) < 12);
}
