#include "cli/support/standard_output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "clearway/error.hpp"

namespace clearway::tool {

void print(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw ResourceError(std::string("standard output: cannot write: ") + std::strerror(errno));
  }
}

void occupy_standard_descriptors() {
  constexpr std::array<int, 3> kModes{O_WRONLY, O_RDONLY, O_RDWR};
  for (int descriptor = 0; descriptor < 3; ++descriptor) {
    if (::fcntl(descriptor, F_GETFD) >= 0) continue;
    if (::open("/dev/null", kModes[descriptor]) != descriptor) {
      throw ResourceError("/dev/null: cannot open: " + std::string(std::strerror(errno)));
    }
  }
}

}  // namespace clearway::tool
